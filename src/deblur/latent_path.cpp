#include "mba_vo/deblur/latent_path.h"

#include <algorithm>

#include <Eigen/LU>

namespace mba_vo {
namespace {

constexpr int kInversions = 6;   // of Newton's method; one without motion between the images, two or three with
constexpr float kClose = 2e-3F;  // [px]
constexpr float kLeastShortening = 0.1F;  // of a path by a rolling shutter
constexpr double kUnitTime = 1e-3;        // exposure along which the sharp image's own motion is measured [s]

ExposureTrajectory ownMotion(const Vector6& velocity) { return {SE3(), velocity, kUnitTime}; }

}  // namespace

LatentPathMaker::LatentPathMaker(const BlurGeometry& geometry)
    : geometry_(geometry),
      maker_(geometry.latent_camera, geometry.camera, geometry.trajectory,
             {geometry.trajectory.motion(), {geometry.latent_velocity}}),
      latent_maker_(geometry.latent_camera, geometry.latent_camera, ownMotion(geometry.latent_velocity),
                    {{geometry.latent_velocity}, {geometry.latent_velocity}}) {}

bool LatentPathMaker::make(const Eigen::Vector2d& latent_pixel, double inverse_depth, LatentPath& result) const {
  Eigen::Vector2f pixel = latent_pixel.cast<float>();
  PatchPath& path = result.path;
  for (int i = 0; i < kInversions; ++i) {
    if (!maker_.makeWithoutPose(pixel.cast<double>(), inverse_depth, path, latent_pixel.y())) return false;
    const Eigen::Vector2f missing = latent_pixel.cast<float>() - path.c0;
    if (missing.squaredNorm() < kClose * kClose) break;
    pixel += path.A0.inverse() * missing;
  }
  if (!pixel.allFinite() || !followRows(latent_pixel, inverse_depth, path)) return false;
  result.pixel = pixel;
  return path.c0.allFinite() && path.c1.allFinite() && path.c2.allFinite();
}

/// With a rolling shutter the sharp image's rows are exposed at their own times, too: what is seen d rows further down
/// has moved by -d row_time times the speed in the sharp image until that row's time.
bool LatentPathMaker::followRows(const Eigen::Vector2d& latent_pixel, double inverse_depth, PatchPath& path) const {
  const double row_time = geometry_.latent_camera.row_time;
  if (row_time == 0.0) return true;
  PatchPath own;
  if (!latent_maker_.makeWithoutPose(latent_pixel, inverse_depth, own, latent_pixel.y())) return false;
  const Eigen::Vector2f per_row = static_cast<float>(row_time / kUnitTime) * own.c1;  // [px]
  const Eigen::Vector2f slant = per_row / std::max(kLeastShortening, 1.0F + per_row.y());
  path.c1 -= path.c1.y() * slant;
  path.c2 -= path.c2.y() * slant;
  return true;
}

}  // namespace mba_vo
