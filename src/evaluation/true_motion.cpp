#include "mba_vo/evaluation/true_motion.h"

#include <algorithm>

namespace mba_vo {
namespace {

constexpr double kStampTolerance = 1e-5;  // decimals written to files [s]

/// First pose at `time` or later, up to rounding.
std::vector<PoseRecord>::const_iterator atOrAfter(const std::vector<PoseRecord>& poses, double time) {
  return std::lower_bound(poses.begin(), poses.end(), time - kStampTolerance,
                          [](const PoseRecord& pose, double t) { return pose.time < t; });
}

Eigen::Vector3d positionAt(const std::vector<PoseRecord>& poses, double time) {
  const auto after = atOrAfter(poses, time);
  if (after == poses.end()) {
    return poses.back().T_world_camera.translation();
  }
  if (after == poses.begin() || after->time <= time) {
    return after->T_world_camera.translation();
  }
  const auto before = std::prev(after);
  const double u = (time - before->time) / (after->time - before->time);
  return (1.0 - u) * before->T_world_camera.translation() + u * after->T_world_camera.translation();
}

}  // namespace

std::optional<SE3> truePoseAt(const std::vector<PoseRecord>& groundtruth, double time) {
  const auto after = atOrAfter(groundtruth, time);
  if (after == groundtruth.end()) {
    return std::nullopt;
  }
  if (after->time <= time + kStampTolerance) {
    return after->T_world_camera;
  }
  constexpr double kLongestGap = 0.1;  // hand-held motion is no longer known beyond, to some millimetres [s]
  if (after == groundtruth.begin() || after->time - std::prev(after)->time > kLongestGap + kStampTolerance) {
    return std::nullopt;
  }
  const auto before = std::prev(after);
  const double u = (time - before->time) / (after->time - before->time);
  const SE3 step = before->T_world_camera.inverse() * after->T_world_camera;
  return before->T_world_camera * SE3::exp(u * step.log());
}

std::optional<double> timeOfDistance(const std::vector<PoseRecord>& groundtruth, double begin, double min_distance) {
  const Eigen::Vector3d origin = positionAt(groundtruth, begin);
  const auto far = [&](const PoseRecord& pose) {
    return (pose.T_world_camera.translation() - origin).norm() >= min_distance;
  };
  const auto found = std::find_if(atOrAfter(groundtruth, begin), groundtruth.end(), far);
  return found == groundtruth.end() ? std::nullopt : std::optional<double>(found->time);
}

}  // namespace mba_vo
