#include "mba_vo/evaluation/association.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace mba_vo {
namespace {

struct Candidate {
  double difference;  // [s]
  Association pair;
};

std::map<int, std::size_t> posesPerMap(const std::vector<PoseRecord>& poses) {
  std::map<int, std::size_t> counts;
  for (const PoseRecord& pose : poses) {
    ++counts[pose.map];
  }
  return counts;
}

}  // namespace

std::vector<Association> associateByTime(const std::vector<PoseRecord>& groundtruth,
                                         const std::vector<PoseRecord>& estimate, double max_difference) {
  std::vector<Candidate> candidates;
  std::size_t first = 0;  // of the ground truth that can still be close enough
  for (std::size_t e = 0; e < estimate.size(); ++e) {
    while (first < groundtruth.size() && groundtruth[first].time < estimate[e].time - max_difference) {
      ++first;
    }
    for (std::size_t g = first; g < groundtruth.size(); ++g) {
      const double difference = std::abs(groundtruth[g].time - estimate[e].time);
      if (difference > max_difference) {
        break;
      }
      candidates.push_back({difference, {g, e}});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.difference < b.difference; });
  std::vector<char> groundtruth_used(groundtruth.size(), 0);
  std::vector<char> estimate_used(estimate.size(), 0);
  std::vector<Association> pairs;
  for (const Candidate& candidate : candidates) {
    char& g_used = groundtruth_used[candidate.pair.groundtruth];
    char& e_used = estimate_used[candidate.pair.estimate];
    if (g_used == 0 && e_used == 0) {
      g_used = e_used = 1;
      pairs.push_back(candidate.pair);
    }
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const Association& a, const Association& b) { return a.groundtruth < b.groundtruth; });
  return pairs;
}

std::vector<PoseRecord> posesOfLargestMap(const std::vector<PoseRecord>& poses) {
  const std::map<int, std::size_t> counts = posesPerMap(poses);
  const auto largest =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<PoseRecord> selected;
  if (counts.empty()) {
    return selected;
  }
  std::copy_if(poses.begin(), poses.end(), std::back_inserter(selected),
               [&](const PoseRecord& pose) { return pose.map == largest->first; });
  return selected;
}

std::size_t countMaps(const std::vector<PoseRecord>& poses) { return posesPerMap(poses).size(); }

}  // namespace mba_vo
