#pragma once

#include <Eigen/Core>

#include "mba_vo/blur/fixed_motion_path.h"

namespace mba_vo {

/// How an image is seen from a sharp one: where the camera was during its exposure, in the axes of the sharp image.
struct BlurGeometry {
  PinholeCamera latent_camera;                // of the sharp image
  PinholeCamera camera;                       // of the blurred image
  ExposureTrajectory trajectory;              // T_reference_mid: blurred image's camera to sharp image's camera
  Vector6 latent_velocity = Vector6::Zero();  // of the sharp image's camera, for a rolling shutter [m/s, rad/s]
};

/// What a pixel of the sharp image has to do with the blurred one.
struct LatentPath {
  Eigen::Vector2f pixel;  // of the blurred image, that looks here at mid-exposure
  PatchPath path;         // of that pixel in the sharp image: c0 is where it began, the sharp image's pixel
};

/// Finds the pixels of a blurred image that look at those of the sharp one, and the paths they take there.
class LatentPathMaker {
 public:
  explicit LatentPathMaker(const BlurGeometry& geometry);

  /// False if the plane of `inverse_depth` [1/m] in the sharp image is behind a camera.
  bool make(const Eigen::Vector2d& latent_pixel, double inverse_depth, LatentPath& result) const;

 private:
  bool followRows(const Eigen::Vector2d& latent_pixel, double inverse_depth, PatchPath& path) const;

  BlurGeometry geometry_;
  FixedMotionPathMaker maker_;
  FixedMotionPathMaker latent_maker_;  // of the sharp image's own motion
};

}  // namespace mba_vo
