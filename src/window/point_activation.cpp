#include "mba_vo/window/point_activation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "mba_vo/blur/row_motion.h"

namespace mba_vo {
namespace {

constexpr double kBorder = 5.0;  // [px]
constexpr double kInitialRelativeSigma = 0.05;

std::optional<RollingProjection> see(const PinholeCamera& camera, const Eigen::Vector3d& point) {
  if (point.z() <= 0.0) return std::nullopt;
  return RollingProjection{camera.project(point), point.z()};
}

}  // namespace

std::vector<ReferencePoint> projectPoints(const Window& window, const std::vector<WindowPoint>& points,
                                          const PinholeCamera& camera, const SE3& T_map_camera,
                                          const BodyMotion& motion) {
  struct Host {
    PinholeCamera camera;
    SE3 T_camera_host;
    MovingPose at_row;  // the host saw the point when its own row was read
  };
  std::map<KeyframeId, Host> hosts;
  for (const KeyframeId id : window.keyframes()) {
    const SE3 T = T_map_camera.inverse() * window.T_map_keyframe(id);
    hosts[id] = {window.camera(id), T, MovingPose(RigidMotion(T), window.motion(id))};
  }
  const bool rolling = camera.row_time != 0.0;
  std::vector<ReferencePoint> projected;
  auto known = hosts.end();  // points of one host come one after the other
  for (const WindowPoint& point : points) {
    if (known == hosts.end() || known->first != point.host) known = hosts.find(point.host);
    const Host& host = known->second;
    const Eigen::Vector3d in_host = host.camera.unproject(point.pixel) / point.inverse_depth;
    const auto seen =
        rolling ? projectRolling(camera, motion, host.at_row.at(host.camera.rowDelay(point.pixel.y())) * in_host)
                : see(camera, host.T_camera_host * in_host);
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

std::vector<ReferencePoint> pointsSeenBy(const Window& window, const std::vector<WindowPoint>& points,
                                         KeyframeId keyframe) {
  return projectPoints(window, points, window.camera(keyframe), window.T_map_keyframe(keyframe),
                       window.motion(keyframe));
}

}  // namespace mba_vo
