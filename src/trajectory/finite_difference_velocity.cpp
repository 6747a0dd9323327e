#include "mba_vo/trajectory/finite_difference_velocity.h"

#include <algorithm>
#include <cstddef>

namespace mba_vo {
namespace {

constexpr std::size_t kPoses = 3;
constexpr double kLongestGap = 0.15;  // [s] the velocity is not constant over longer gaps
// [rad/s^3] What a measured turn says beyond it is an error, of which one in twenty has tenths of a rad/s
// (docs/decisions/2026-11-28-motion-of-keyframes.md).
constexpr double kMostJerk = 550.0;
// Of what a way gained from one interval to the next, so much is gained until the end of the second: 1/2 if it were
// accelerated evenly for long, less as hands change their mind
// (docs/decisions/2026-11-28-published-velocities.md).
constexpr double kWayGained = 1.0 / 3.0;

Eigen::Vector3d bounded(const Eigen::Vector3d& v, double most) {
  return v * std::min(1.0, most / std::max(v.norm(), 1e-12));
}

}  // namespace

std::optional<ObservedMotion> observedMotion(const TrackedFrame& frame) {
  const ExposureTrajectory& found = frame.trajectory;
  if (frame.frame->pyramid.level(0).camera.row_time != 0.0) {
    return ObservedMotion{found.velocity, Eigen::Vector3d(found.acceleration.tail<3>())};
  }
  if (frame.frame->exposure.value_or(0.0) <= 0.0) return std::nullopt;
  return ObservedMotion{found.velocity, std::nullopt};
}

void FiniteDifferenceVelocity::add(std::int64_t mid_exposure_ns, const SE3& T_map_camera,
                                   const std::optional<ObservedMotion>& measured) {
  if (!poses_.empty() && mid_exposure_ns <= poses_.back().ns) return;
  poses_.push_back({mid_exposure_ns, T_map_camera, measured});
  if (poses_.size() > kPoses) poses_.pop_front();
}

double FiniteDifferenceVelocity::secondsTo(std::size_t i) const {
  return 1e-9 * static_cast<double>(poses_[i].ns - poses_[i - 1].ns);
}

Vector6 FiniteDifferenceVelocity::velocityTo(std::size_t i) const {
  return (poses_[i - 1].T_map_camera.inverse() * poses_[i].T_map_camera).log() / secondsTo(i);
}

bool FiniteDifferenceVelocity::knowsBothSides() const {
  return poses_.size() == kPoses && std::max(secondsTo(1), secondsTo(2)) <= kLongestGap;
}

bool FiniteDifferenceVelocity::knowsBefore() const {
  return poses_.size() > 1 && secondsTo(poses_.size() - 1) <= kLongestGap;
}

Vector6 FiniteDifferenceVelocity::velocityOfMiddle() const {
  Vector6 velocities = Vector6::Zero();
  int count = 0;
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    if (secondsTo(i) > kLongestGap) continue;
    velocities += velocityTo(i);
    ++count;
  }
  if (count == 0) return Vector6::Zero();
  Vector6 velocity = velocities / count;
  const auto measured = [&](const Pose& pose) { return pose.measured.has_value(); };
  if (!knowsBothSides() || !std::all_of(poses_.begin(), poses_.end(), measured)) return velocity;
  // The central difference exceeds the velocity by a sixth of its second difference. An error that all measured
  // velocities have in common, that of the reference, cancels there. Hands change the rate of a turn so fast that it
  // counts, but not how fast they move: there it would only add the errors of the measured velocities.
  const double most = kMostJerk * secondsTo(1) * secondsTo(2);
  velocity.tail<3>() -= bounded(measuredTurn(0) - 2.0 * measuredTurn(1) + measuredTurn(2), most) / 6.0;
  return velocity;
}

BodyMotion FiniteDifferenceVelocity::motionOfMiddle() const {
  BodyMotion motion{velocityOfMiddle()};
  if (!knowsBothSides()) return motion;
  motion.acceleration = (velocityTo(2) - velocityTo(1)) / (0.5 * (secondsTo(1) + secondsTo(2)));
  const auto& measured = poses_[1].measured;
  if (!measured || !measured->angular_acceleration) return motion;
  auto turn = motion.acceleration.tail<3>();
  turn = 0.5 * (turn + *measured->angular_acceleration);
  return motion;
}

BodyMotion FiniteDifferenceVelocity::motionOfLast() const {
  BodyMotion motion;
  if (poses_.empty()) return motion;
  const std::size_t last = poses_.size() - 1;
  const auto& measured = poses_[last].measured;
  const bool follows = last > 0 && secondsTo(last) <= kLongestGap;
  if (measured && (measured->angular_acceleration || !follows)) {
    motion.velocity = measured->velocity;
    motion.acceleration.tail<3>() = measured->angular_acceleration.value_or(Eigen::Vector3d::Zero());
  } else if (follows) {
    motion.velocity = velocityTo(last);
    motion.velocity.tail<3>() += 0.5 * turnGainedTo(last);
  }
  return motion;
}

BodyMotion FiniteDifferenceVelocity::bestOfLast() const {
  BodyMotion motion = motionOfLast();
  if (!knowsBefore()) return motion;
  const std::size_t last = poses_.size() - 1;
  const Vector6 mean = velocityTo(last);
  motion.velocity.head<3>() = mean.head<3>();
  if (last < 2 || secondsTo(last - 1) > kLongestGap) return motion;
  motion.velocity.head<3>() += kWayGained * (mean - velocityTo(last - 1)).head<3>();
  const auto& measured = poses_[last].measured;
  if (!measured || measured->angular_acceleration) return motion;
  // What it has gained and what is measured, both bounded: their errors differ.
  const Eigen::Vector3d evenly = 1.5 * mean.tail<3>() - 0.5 * velocityTo(last - 1).tail<3>();
  const double most = 0.5 * kMostJerk * secondsTo(last) * secondsTo(last);
  const Eigen::Vector3d by_blur = evenly + bounded(measuredTurn(last) - evenly, most);
  motion.velocity.tail<3>() = 0.5 * (motion.velocity.tail<3>() + by_blur);
  return motion;
}

/// By the measured velocities, as far as the poses allow. Zero if there are too few.
Eigen::Vector3d FiniteDifferenceVelocity::turnGainedTo(std::size_t i) const {
  if (i < 2 || secondsTo(i - 1) > kLongestGap) return Eigen::Vector3d::Zero();
  Eigen::Vector3d gained = (velocityTo(i) - velocityTo(i - 1)).tail<3>();
  if (poses_[i].measured && poses_[i - 1].measured) {
    const double most = 0.5 * kMostJerk * secondsTo(i) * secondsTo(i);
    gained += bounded(measuredTurn(i) - measuredTurn(i - 1) - gained, most);
  }
  return gained;
}

Eigen::Vector3d FiniteDifferenceVelocity::measuredTurn(std::size_t i) const {
  return poses_[i].measured->velocity.tail<3>();
}

}  // namespace mba_vo
