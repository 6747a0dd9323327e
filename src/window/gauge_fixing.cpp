#include "mba_vo/window/gauge_fixing.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mba_vo {
namespace {

constexpr std::size_t kLeastPoints = 20;  // that tell how the scale has changed

/// The least value such that those up to it have half the weight. (value, weight)
double weightedMedian(std::vector<std::pair<double, double>> values) {
  std::sort(values.begin(), values.end());
  double total = 0.0;
  for (const auto& [value, weight] : values) total += weight;
  double sum = 0.0;
  for (const auto& [value, weight] : values) {
    sum += weight;
    if (sum >= 0.5 * total) return value;
  }
  return 0.0;
}

void scaleLength(Vector6& motion, double scale) { motion.head<3>() *= scale; }

}  // namespace

GaugeFixing::GaugeFixing(const WindowState& state) : any_scale_(!state.hasMeasuredDepths()) {
  for (int i = 0; i + 1 < state.size(); ++i) T_map_keyframe_.push_back(state.keyframe(i).T_map_keyframe());
  for (const PointState& point : state.points) points_.push_back({point.id, point.inverse_depth});
}

/// By which the window has shrunk.
double GaugeFixing::scaleOf(const WindowState& state) const {
  if (!any_scale_) return 1.0;
  std::vector<std::pair<double, double>> changes;  // of the log of the inverse depth, and how well that is known
  auto before = points_.begin();
  for (const PointState& point : state.points) {
    while (before != points_.end() && before->id < point.id) ++before;
    if (before == points_.end()) break;
    if (before->id != point.id) continue;
    const double relative_information = point.information * point.inverse_depth * point.inverse_depth;
    changes.emplace_back(std::log(point.inverse_depth / before->inverse_depth), relative_information);
  }
  return changes.size() < kLeastPoints ? 1.0 : std::exp(weightedMedian(std::move(changes)));
}

void GaugeFixing::restore(WindowState& state) const {
  if (T_map_keyframe_.empty()) return;
  const double scale = scaleOf(state);
  const double share = 1.0 / static_cast<double>(T_map_keyframe_.size());
  Vector6 turn = Vector6::Zero();
  Eigen::Vector3d centre_before = Eigen::Vector3d::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < T_map_keyframe_.size(); ++i) {
    const SE3& before = T_map_keyframe_[i];
    const SE3 now = state.keyframes[i].T_map_keyframe();
    const SE3 turned(before.rotation() * now.rotation().conjugate(), Eigen::Vector3d::Zero());
    turn += share * turned.log();
    centre_before += share * before.translation();
    centre += share * now.translation();
  }
  const Eigen::Quaterniond rotation = SE3::exp(turn).rotation();
  for (KeyframeState& keyframe : state.keyframes) {
    const SE3 now = keyframe.T_map_keyframe();
    const SE3 moved(rotation * now.rotation(), centre_before + scale * (rotation * (now.translation() - centre)));
    keyframe.delta.head<6>() = (keyframe.T_linear.inverse() * moved).log();
    scaleLength(keyframe.xi, scale);
    scaleLength(keyframe.image_xi, scale);
    scaleLength(keyframe.velocity, scale);
    scaleLength(keyframe.expected_velocity, scale);
    scaleLength(keyframe.acceleration, scale);
  }
  state.relinearize();
  for (PointState& point : state.points) {
    point.inverse_depth /= scale;
    point.slope /= scale;
    point.information *= scale * scale;
  }
}

}  // namespace mba_vo
