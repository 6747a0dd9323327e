#include "mba_vo/evaluation/clock_hint.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "mba_vo/evaluation/clock_offset.h"

namespace mba_vo {
namespace {

/// Share of the poses within the time of the ground truth when `offset` [s] is added to their stamps.
double covered(const std::vector<PoseRecord>& groundtruth, const std::vector<PoseRecord>& estimate, double offset) {
  const auto inside = std::count_if(estimate.begin(), estimate.end(), [&](const PoseRecord& pose) {
    return pose.time + offset >= groundtruth.front().time && pose.time + offset <= groundtruth.back().time;
  });
  return static_cast<double>(inside) / static_cast<double>(estimate.size());
}

/// The offset that makes the angular speeds agree, near `guess` [s]; empty if it is not evident.
std::string offsetHint(const std::vector<PoseRecord>& groundtruth, const std::vector<PoseRecord>& estimate,
                       double guess) {
  const std::optional<double> offset = findClockOffset(groundtruth, estimate, guess);
  if (!offset) return "";
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << "by the angular speeds the ground truth seems to be "
       << std::abs(*offset) << " s " << (*offset > 0.0 ? "late" : "early") << ": --time-offset " << *offset;
  return text.str();
}

}  // namespace

std::string clockHint(const std::vector<PoseRecord>& groundtruth, const std::vector<PoseRecord>& estimate) {
  if (groundtruth.empty() || estimate.empty()) {
    return "";
  }
  constexpr double kMost = 0.5;  // of the poses
  const double offset = groundtruth.front().time - estimate.front().time;
  if (covered(groundtruth, estimate, 0.0) >= kMost) return offsetHint(groundtruth, estimate, 0.0);
  if (covered(groundtruth, estimate, offset) < kMost) return "";
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << "the clocks seem to differ: the estimate covers "
       << estimate.front().time << " to " << estimate.back().time << " s, the ground truth " << groundtruth.front().time
       << " to " << groundtruth.back().time << " s; with " << offset
       << " s added to the times of the estimate their first stamps would meet";
  const std::string hint = offsetHint(groundtruth, estimate, offset);
  return text.str() + (hint.empty() ? "" : "; " + hint);
}

}  // namespace mba_vo
