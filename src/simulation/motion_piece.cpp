#include "mba_vo/simulation/motion_piece.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "mba_vo/simulation/content_hash.h"

namespace mba_vo {
namespace {

constexpr double kNeighbourhood = 0.1;  // [s] of poses beyond a piece; a tenth pose away has an influence of 1e-6
constexpr double kRounding = 1e-6;      // [s] of the times in a file

/// Heights above the floor that a recording's own floor may give to the lowest point of a camera [m] ...
constexpr double kLowestPlausible = 0.5;
constexpr double kHighestPlausible = 2.0;
constexpr double kLowestOtherwise = 0.9;  // ... and the height where it does not

/// The piece's length [s]. Throws if the motion has no such piece.
double checkedLength(const SimulationConfig& config, double available) {
  const double length = config.duration > 0.0 ? config.duration : available - config.start;
  if (config.start + length > available + kRounding || length <= 0.0) {
    std::ostringstream message;
    message << "start = " << config.start << " s";
    if (config.duration > 0.0) message << " with duration = " << config.duration << " s";
    message << " reaches beyond the " << available << " s of '" << config.motion << "'";
    throw std::invalid_argument(message.str());
  }
  return length;
}

/// Moves the middle of the path to x = y = 0 and, where the recorded height is no height over a floor, lifts it.
void placeOverFloor(std::vector<TimedPose>& poses) {
  Eigen::AlignedBox3d box;
  for (const TimedPose& pose : poses) box.extend(pose.T_world_camera.translation());
  Eigen::Vector3d shift = -box.center();
  const double lowest = box.min().z();
  const bool plausible = lowest >= kLowestPlausible && lowest <= kHighestPlausible;
  shift.z() = plausible ? 0.0 : kLowestOtherwise - lowest;
  for (TimedPose& pose : poses) {
    pose.T_world_camera = SE3(pose.T_world_camera.rotation(), pose.T_world_camera.translation() + shift);
  }
}

std::uint64_t hashOf(const std::vector<TimedPose>& poses) {
  std::vector<double> numbers;
  for (const TimedPose& pose : poses) {
    const Eigen::Vector3d& p = pose.T_world_camera.translation();
    const Eigen::Vector4d& q = pose.T_world_camera.rotation().coeffs();
    numbers.insert(numbers.end(), {pose.t, p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
  }
  return contentHash(numbers.data(), numbers.size() * sizeof(double));
}

}  // namespace

MotionPiece::MotionPiece(const SimulationConfig& config) : MotionPiece(cut(config)) {}

MotionPiece::MotionPiece(const SimulationConfig& config, const std::vector<TimedPose>& poses, double first_frame,
                         double span)
    : first_frame_(first_frame), span_(span), margin_(config.exposureMargin()), hash_(hashOf(poses)), motion_(poses) {}

MotionPiece MotionPiece::cut(const SimulationConfig& config) {
  const std::vector<TimedPose> all = readMotionFile(config.motion);
  const double length = checkedLength(config, all.back().t - all.front().t);
  const double margin = config.exposureMargin();
  if (length < 2.0 * margin) {
    throw std::invalid_argument("duration = " + std::to_string(length) + " s is shorter than one exposure of " +
                                std::to_string(2.0 * margin) + " s");
  }
  const double begin = all.front().t + config.start;
  std::vector<TimedPose> poses;
  for (const TimedPose& pose : all) {
    if (pose.t > begin - kNeighbourhood && pose.t < begin + length + kNeighbourhood) poses.push_back(pose);
  }
  placeOverFloor(poses);
  return {config, poses, begin + margin, length - 2.0 * margin};
}

std::vector<Eigen::Vector3d> MotionPiece::path() const {
  constexpr double kStep = 0.001;    // [s]
  constexpr double kSpacing = 0.01;  // [m]
  std::vector<Eigen::Vector3d> points;
  const auto add = [&](const Eigen::Vector3d& p) {
    if (points.empty() || (p - points.back()).norm() > kSpacing) points.push_back(p);
  };
  for (double t = -margin_; t < span_ + margin_; t += kStep) add(pose(t).translation());
  points.push_back(pose(span_ + margin_).translation());
  return points;
}

}  // namespace mba_vo
