#include "mba_vo/mapping/kinematic_blur.h"

#include <cstddef>

namespace mba_vo {
namespace {

constexpr std::size_t kPoses = 3;
constexpr double kLongestGap = 0.15;  // [s] the velocity is not constant over longer gaps

}  // namespace

void KinematicBlur::add(std::int64_t mid_exposure_ns, const SE3& T_map_camera) {
  if (!poses_.empty() && mid_exposure_ns <= poses_.back().ns) return;
  poses_.push_back({mid_exposure_ns, T_map_camera});
  if (poses_.size() > kPoses) poses_.pop_front();
}

Vector6 KinematicBlur::xiOfMiddle(double exposure) const {
  Vector6 velocities = Vector6::Zero();
  int count = 0;
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    const double dt = 1e-9 * static_cast<double>(poses_[i].ns - poses_[i - 1].ns);
    if (dt > kLongestGap) continue;
    velocities += (poses_[i - 1].T_map_camera.inverse() * poses_[i].T_map_camera).log() / dt;
    ++count;
  }
  return count > 0 ? Vector6(exposure * velocities / count) : Vector6::Zero();
}

}  // namespace mba_vo
