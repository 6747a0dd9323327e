#include "mba_vo/mapping/point_activation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "mba_vo/blur/row_motion.h"

namespace mba_vo {
namespace {

constexpr double kMinDistance = 2.0;    // [px]
constexpr double kMaxDistance = 30.0;   // [px]
constexpr double kCertainSearch = 8.0;  // [px] a longer last search leaves the depth ambiguous
constexpr double kMinQuality = 3.0;
constexpr double kBorder = 5.0;  // [px]
constexpr double kInitialRelativeSigma = 0.05;

std::optional<RollingProjection> see(const PinholeCamera& camera, const Eigen::Vector3d& point) {
  if (point.z() <= 0.0) return std::nullopt;
  return RollingProjection{camera.project(point), point.z()};
}

/// The host saw the point when its own row was read.
std::optional<RollingProjection> seeRolling(const PinholeCamera& camera, const Vector6& velocity,
                                            const SE3& T_camera_host, const Vector6& host_velocity,
                                            const Eigen::Vector2d& host_pixel, const Eigen::Vector3d& in_host) {
  const RigidMotion to_row = shortMotion(host_velocity, camera.rowDelay(host_pixel.y()));
  return projectRolling(camera, velocity, T_camera_host * (to_row.R * in_host + to_row.p));
}

}  // namespace

SpacingGrid::SpacingGrid(const PinholeCamera& camera, double distance_px)
    : distance_px_(distance_px),
      columns_(static_cast<int>(std::ceil(camera.width / distance_px)) + 1),
      rows_(static_cast<int>(std::ceil(camera.height / distance_px)) + 1),
      occupied_(static_cast<std::size_t>(columns_ * rows_), false) {}

std::size_t SpacingGrid::cell(const Eigen::Vector2d& pixel) const {
  const int column = std::clamp(static_cast<int>(pixel.x() / distance_px_), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(pixel.y() / distance_px_), 0, rows_ - 1);
  return static_cast<std::size_t>(row * columns_ + column);
}

double adaptedDistance(double distance_px, int points, int wanted) {
  const double ratio = static_cast<double>(points) / std::max(wanted, 1);
  const double factor = std::clamp(std::sqrt(ratio), 0.8, 1.25);
  return std::clamp(factor * distance_px, kMinDistance, kMaxDistance);
}

bool isReadyToActivate(const ImmaturePoint& point) {
  using State = ImmaturePoint::State;
  if (point.measured.known()) return true;
  const bool searched = point.state == State::kGood || point.state == State::kSkipped ||
                        point.state == State::kBadCondition || point.state == State::kOutOfBounds;
  return searched && point.hasDepth() && point.inverseDepth() > 0.0 && point.last_search_length_px < kCertainSearch &&
         point.quality > kMinQuality;
}

std::vector<ReferencePoint> projectPoints(const Window& window, const PinholeCamera& camera, const SE3& T_map_camera,
                                          const Vector6& velocity) {
  std::map<KeyframeId, SE3> T_camera_host;
  for (const KeyframeId id : window.keyframes()) {
    T_camera_host[id] = T_map_camera.inverse() * window.T_map_keyframe(id);
  }
  const bool rolling = camera.row_time != 0.0;
  std::vector<ReferencePoint> projected;
  for (const WindowPoint& point : window.points()) {
    const Eigen::Vector3d in_host = camera.unproject(point.pixel) / point.inverse_depth;
    const SE3& T = T_camera_host.at(point.host);
    const auto seen = rolling ? seeRolling(camera, velocity, T, window.velocity(point.host), point.pixel, in_host)
                              : see(camera, T * in_host);
    if (!seen || !camera.contains(seen->pixel, kBorder)) continue;
    const Eigen::Vector2d& pixel = seen->pixel;
    const double inverse_depth = 1.0 / seen->depth;
    const double ratio = inverse_depth / point.inverse_depth;
    // A point without residuals knows its depth from initialisation only.
    const double initial_sigma = kInitialRelativeSigma * point.inverse_depth;
    const double variance = std::min(kResidualVariance * point.variance, initial_sigma * initial_sigma);
    projected.push_back({pixel.cast<float>(), static_cast<float>(inverse_depth),
                         static_cast<float>(variance * ratio * ratio * ratio * ratio)});
  }
  return projected;
}

std::vector<ReferencePoint> pointsSeenBy(const Window& window, const PinholeCamera& camera, KeyframeId keyframe) {
  return projectPoints(window, camera, window.T_map_keyframe(keyframe), window.velocity(keyframe));
}

}  // namespace mba_vo
