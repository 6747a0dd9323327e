#pragma once

#include <vector>

#include <Eigen/Core>

#include "mba_vo/geometry/pinhole_camera.h"
#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// One image's observations of the points of the reference.
struct BundleView {
  SE3 T_view_reference;
  double sigma = 1.0;                  // of an observation in this image [px]; blurred images have a larger one
  std::vector<Eigen::Vector2d> pixel;  // by point [px]
  std::vector<char> observed;          // by point; 0 = not seen, or found to be an outlier
  std::vector<Eigen::Vector2d> pixel_by_row_time;  // by point: its derivative [px/s]; see Bundle::row_time
};

/// Points of a reference image (at the identity) by their inverse depth along a fixed ray, and other images that saw
/// them.
struct Bundle {
  PinholeCamera camera;
  std::vector<Eigen::Vector3d> rays;  // in the reference, z = 1
  std::vector<double> inverse_depth;  // [1/m], any sign while optimising
  std::vector<BundleView> views;
  /// That pixels and rays are at, by their derivatives [s]. A variable, too, if there are such.
  double row_time = 0.0;
  std::vector<Eigen::Vector3d> ray_by_row_time;  // [1/s]

  bool findsRowTime() const { return !ray_by_row_time.empty(); }
  /// Takes pixels and rays to another row time.
  void setRowTime(double seconds);
};

struct BundleOptions {
  int max_iterations = 15;
  double huber = 1.5;               // threshold of residuals over sigma
  double relative_decrease = 1e-5;  // stop below it
};

struct BundleSummary {
  double initial_cost = 0.0;  // sum of Huber losses of residuals over sigma
  double final_cost = 0.0;
  int iterations = 0;
  int observations = 0;
};

/// Residual of a point with ray `ray` and inverse depth w: pi(R ray + w t) - pixel, with derivatives by a left
/// increment of T = (R, t), T <- Exp(d) T, by w and by the ray. Writing the point as (ray, w) keeps far points regular
/// (w -> 0).
struct ReprojectionTerm {
  Eigen::Vector2d residual;  // [px]
  Eigen::Matrix<double, 2, 6> J_pose;
  Eigen::Vector2d J_inverse_depth;
  Eigen::Matrix<double, 2, 3> J_ray;
  bool in_front = false;
};
ReprojectionTerm reprojectionTerm(const PinholeCamera& camera, const SE3& T_view_reference, const Eigen::Vector3d& ray,
                                  double inverse_depth, const Eigen::Vector2d& pixel);

/// Levenberg-Marquardt over all poses and inverse depths, and the row time if it is to be found; points are eliminated
/// by the Schur complement. The scale is free (its null direction is held by the damping), the caller normalises it.
BundleSummary optimizeBundle(Bundle& bundle, const BundleOptions& options);

/// The same over one view's pose with the points held fixed.
BundleSummary optimizePose(const Bundle& bundle, BundleView& view, const BundleOptions& options);

/// Reprojection errors of the observed points [px]; infinite behind the camera.
std::vector<double> reprojectionErrors(const Bundle& bundle, const BundleView& view);

/// Sets the standard deviation of each view's observations by the median error; the errors are Rayleigh-distributed.
void estimateSigmas(Bundle& bundle);

/// Variance of each inverse depth with the poses held fixed [1/m^2]; infinite where unobserved.
std::vector<double> inverseDepthVariances(const Bundle& bundle);

/// Makes the median inverse depth of the observed points 1 by changing the scale. The sign with it: (w, t) and (-w, -t)
/// are the same images, so that the optimiser may end on either.
void normalizeScale(Bundle& bundle);

}  // namespace mba_vo
