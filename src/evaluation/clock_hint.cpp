#include "mba_vo/evaluation/clock_hint.h"

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace mba_vo {
namespace {

/// Share of the poses within the time of the ground truth when `offset` [s] is added to their stamps.
double covered(const std::vector<PoseRecord>& groundtruth, const std::vector<PoseRecord>& estimate, double offset) {
  const auto inside = std::count_if(estimate.begin(), estimate.end(), [&](const PoseRecord& pose) {
    return pose.time + offset >= groundtruth.front().time && pose.time + offset <= groundtruth.back().time;
  });
  return static_cast<double>(inside) / static_cast<double>(estimate.size());
}

}  // namespace

std::string clockHint(const std::vector<PoseRecord>& groundtruth, const std::vector<PoseRecord>& estimate) {
  if (groundtruth.empty() || estimate.empty()) {
    return "";
  }
  constexpr double kMost = 0.5;  // of the poses
  const double offset = groundtruth.front().time - estimate.front().time;
  if (covered(groundtruth, estimate, 0.0) >= kMost || covered(groundtruth, estimate, offset) < kMost) {
    return "";
  }
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << "the clocks seem to differ: the estimate covers "
       << estimate.front().time << " to " << estimate.back().time << " s, the ground truth " << groundtruth.front().time
       << " to " << groundtruth.back().time << " s; with " << offset
       << " s added to the times of the estimate their first stamps would meet";
  return text.str();
}

}  // namespace mba_vo
