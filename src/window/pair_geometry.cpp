#include "mba_vo/window/pair_geometry.h"

#include <cmath>

#include "mba_vo/image/parallel_for.h"

namespace mba_vo {
namespace {

/// How far a lens that lacks this correction moves the image of a point [px].
Eigen::Vector2d lensShift(const PinholeCamera& camera, const CalibrationCorrection& lacking,
                          const Eigen::Vector2d& pixel) {
  if (!lacking.correctsLens()) return Eigen::Vector2d::Zero();
  return lensJacobian(camera, pixel) * lacking.values;
}

/// Images made with another correction than is right show everything a little beside its place.
void applyLens(const PairGeometry& pair, const Eigen::Vector2d& pixel, PatchPath& path) {
  if (pair.lacking_host.correctsLens()) {
    path.c0 += lensShift(pair.host_camera, pair.lacking_host, path.c0.cast<double>()).cast<float>();
  }
  if (pair.lacking_target.correctsLens()) {
    path.c0 -= path.A0 * lensShift(pair.target_camera, pair.lacking_target, pixel).cast<float>();
  }
}

bool makeWithPose(const FixedMotionPathMaker& maker, const PairGeometry& pair, const Eigen::Vector2i& centre,
                  const PointState& point, PatchPath& path) {
  const Eigen::Vector2d pixel = centre.cast<double>();
  if (!maker.make(pixel, point.inverse_depth, path, point.pixel.y())) return false;
  applyLens(pair, pixel, path);
  applySlope(point.slope, point.pixel, path, SlopeDerivatives::kPose);
  return true;
}

/// With the row time as is known now.
PinholeCamera cameraOf(const ImageLevel& image, const KeyframeState& keyframe) {
  PinholeCamera camera = image.camera;
  camera.row_time += keyframe.lacking[CalibrationCorrection::kReadout] / camera.height;
  return camera;
}

}  // namespace

std::optional<Eigen::Vector2d> projectIntoTarget(const PairGeometry& pair, const Eigen::Vector2d& host_pixel,
                                                 double inverse_depth) {
  const PinholeCamera& host = pair.host_camera;
  const PinholeCamera& target = pair.target_camera;
  const Eigen::Vector3d ray = host.unproject(host_pixel - lensShift(host, pair.lacking_host, host_pixel));
  if (host.row_time != 0.0 || target.row_time != 0.0) {
    const RigidMotion to_row = shortMotion(pair.rows.reference.until(host.rowDelay(host_pixel.y())));
    const Eigen::Vector3d in_host = to_row.R * (ray / inverse_depth) + to_row.p;
    const auto seen = projectRolling(target, pair.rows.camera, pair.T_target_host * in_host);
    if (!seen) return std::nullopt;
    return seen->pixel + lensShift(target, pair.lacking_target, seen->pixel);
  }
  const Eigen::Vector3d point = pair.T_target_host.rotation() * ray + inverse_depth * pair.T_target_host.translation();
  if (point.z() <= 0.0) return std::nullopt;
  const Eigen::Vector2d pixel = target.project(point);
  return pixel + lensShift(target, pair.lacking_target, pixel);
}

bool makePath(const PairGeometry& pair, const Eigen::Vector2i& centre, const PointState& point, PatchPath& path) {
  const Eigen::Vector2d pixel = centre.cast<double>();
  if (!pair.path->makeWithoutPose(pixel, point.inverse_depth, path, point.pixel.y())) return false;
  applyLens(pair, pixel, path);
  applySlope(point.slope, point.pixel, path, SlopeDerivatives::kInverseDepth);
  return true;
}

bool makeJacobianPath(const PairGeometry& pair, const Eigen::Vector2i& centre, const PointState& point,
                      PatchPath& path) {
  const FixedMotionPathMaker& maker = pair.first_path ? *pair.first_path : *pair.path;
  return makeWithPose(maker, pair, centre, point, path);
}

bool makeCurrentJacobianPath(const PairGeometry& pair, const Eigen::Vector2i& centre, const PointState& point,
                             PatchPath& path) {
  return makeWithPose(*pair.path, pair, centre, point, path);
}

PairGeometry makePairGeometry(const KeyframeState& host, const KeyframeState& target, bool reblur_targets) {
  PairGeometry pair;
  pair.blurred = reblur_targets && !target.xi.isZero(0.0);
  pair.host_image = &host.sharp->level(0);
  pair.target_image = reblur_targets ? &target.original->level(0) : &target.sharp->level(0);
  pair.huber_threshold = target.huber_threshold;
  pair.precision = target.precision;
  pair.rows = {target.motion(), host.motion()};
  pair.host_camera = cameraOf(*pair.host_image, host);
  pair.target_camera = cameraOf(*pair.target_image, target);
  pair.lacking_host = host.lacking;
  pair.lacking_target = target.lacking;
  pair.vignette = {pair.host_camera, host.lacking, pair.target_camera, target.lacking};
  const auto makePaths = [&](const SE3& T_host_target) {
    return FixedMotionPathMaker(pair.host_camera, pair.target_camera,
                                {T_host_target, target.xi, pair.blurred ? 1.0 : 0.0}, pair.rows);
  };
  const SE3 T_host_target = host.T_map_keyframe().inverse() * target.T_map_keyframe();
  const SE3 T_host_target_first = host.T_linear.inverse() * target.T_linear;
  pair.T_target_host = T_host_target.inverse();
  if (reblur_targets && !host.image_xi.isZero(0.0)) {
    pair.commuted.emplace(pair.host_image->camera, pair.target_image->camera, T_host_target, host.image_xi);
  }
  pair.path = makePaths(T_host_target);
  if (!host.delta.head<6>().isZero(0.0) || !target.delta.head<6>().isZero(0.0)) {
    pair.first_path = makePaths(T_host_target_first);
  }
  const AffineBrightness host_brightness = host.brightness();
  const AffineBrightness target_brightness = target.brightness();
  pair.gain = static_cast<float>(std::exp(target_brightness.a - host_brightness.a));
  pair.offset_host = static_cast<float>(host_brightness.b);
  pair.offset_target = static_cast<float>(target_brightness.b);
  // T_ht' = Exp(-d_h) T_ht = T_ht Exp(-Ad(T_ht^-1) d_h); a enters as a_t - a_h; b_h as -gain b_h.
  pair.J_host.topLeftCorner<6, 6>() = -T_host_target_first.inverse().adjoint();
  pair.J_host(6, 6) = -1.0;
  pair.J_host(7, 7) = -std::exp(target.brightness_linear.a - host.brightness_linear.a);
  return pair;
}

namespace {

/// `wanted`: by number.
std::vector<PairGeometry> makeWanted(const WindowState& state, bool reblur_targets, const std::vector<bool>& wanted) {
  const auto n = static_cast<std::size_t>(state.size());
  std::vector<PairGeometry> pairs(n * n);
  parallelFor(n, [&](std::size_t h) {
    for (std::size_t t = 0; t < n; ++t) {
      if (h == t || !wanted[h * n + t]) continue;
      pairs[h * n + t] = makePairGeometry(state.keyframes[h], state.keyframes[t], reblur_targets);
    }
  });
  return pairs;
}

}  // namespace

std::vector<PairGeometry> makePairGeometries(const WindowState& state, bool reblur_targets) {
  return makeWanted(state, reblur_targets, std::vector<bool>(state.keyframes.size() * state.keyframes.size(), true));
}

std::vector<PairGeometry> makePairGeometries(const WindowState& state, bool reblur_targets,
                                             const std::vector<int>& points) {
  std::vector<bool> wanted(state.keyframes.size() * state.keyframes.size(), false);
  for (const int i : points) {
    const PointState& point = state.points[static_cast<std::size_t>(i)];
    for (const PatchResidual& residual : point.residuals) {
      wanted[static_cast<std::size_t>(point.host * state.size() + residual.target)] = true;
    }
  }
  return makeWanted(state, reblur_targets, wanted);
}

}  // namespace mba_vo
