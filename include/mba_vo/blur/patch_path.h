#pragma once

#include <array>

#include <Eigen/Core>

#include "mba_vo/blur/row_motion.h"
#include "mba_vo/geometry/exposure_trajectory.h"
#include "mba_vo/geometry/pinhole_camera.h"

namespace mba_vo {

using Matrix26 = Eigen::Matrix<double, 2, 6>;

/// Where one pixel of the blurred image looks in the reference (paper, "More details on the transfer").
/// P = p + s g with g = R r, s = (d - p_z) / g_z on the fronto-parallel plane z = d = 1 / inverse_depth of the
/// reference.
struct PixelTransfer {
  bool valid = false;               // false if the plane is behind either camera
  Eigen::Vector2d pixel;            // in the reference [px]
  Matrix26 J_pose;                  // d pixel / d right increment (rho, phi) of T_reference_camera
  Eigen::Vector2d J_inverse_depth;  // d pixel / d inverse depth [px m]
};

PixelTransfer transferPixel(const PinholeCamera& reference_camera, const PinholeCamera& camera,
                            const SE3& T_reference_camera, const Eigen::Vector2d& pixel, double inverse_depth);

/// Image path in the reference of a small patch of the blurred image while the shutter is open. The path of the centre
/// is c(u) = c0 + u c1 + u^2 c2, u in [-1/2, 1/2]; a pixel at offset delta from the centre follows c(u) + (A0 + u A1)
/// delta.
struct PatchPath {
  Eigen::Vector2f c0, c1, c2;  // [px]
  Eigen::Matrix2f A0, A1;
  // Derivatives of the path, linear in u: d x / d delta = J_pose[0] + u J_pose[1] for a right increment of T_mid and
  // d x / d xi = J_xi_row + u (J_xi[0] + u J_xi[1]).
  std::array<Matrix26, 2> J_pose{Matrix26::Zero(), Matrix26::Zero()};
  std::array<Matrix26, 2> J_xi{Matrix26::Zero(), Matrix26::Zero()};
  Matrix26 J_xi_row = Matrix26::Zero();  // with a rolling shutter, by the time of the row
  double row = 0.0;                      // that time, in exposures
  std::array<Eigen::Vector2d, 2> J_inverse_depth;

  /// Length of the path of the centre [px].
  float length() const;
};

/// Turns a path made for a fronto-parallel plane into that for the slanted plane with inverse depth d + slope . (x -
/// anchor) at pixel x of the reference, d being that of the fronto-parallel one. Path and derivatives, as far as they
/// are wanted, are those of the slanted plane; parallax so large that the plane is seen nearly edge-on is limited.
enum class SlopeDerivatives { kInverseDepth, kPose, kAll };  // each with those before it; kAll: by xi too
void applySlope(const Eigen::Vector2d& slope, const Eigen::Vector2d& anchor, PatchPath& path,
                SlopeDerivatives wanted = SlopeDerivatives::kAll);

/// Makes the paths of many patches for one exposure trajectory (relative to the reference); what depends on the
/// trajectory alone is computed once. With a rolling shutter (PinholeCamera::row_time) the rows of the patch's centre
/// and of the point in the reference stand for the whole patch, and the exposure must not be 0. The rows of the camera
/// follow the trajectory, those of the reference its `reference_motion`.
class PatchPathMaker {
 public:
  PatchPathMaker(const PinholeCamera& reference_camera, const PinholeCamera& camera,
                 const ExposureTrajectory& trajectory, const BodyMotion& reference_motion = {});

  /// Path of the patch around `pixel` of the blurred image on the plane of `inverse_depth` in the reference. Returns
  /// false if any part of the path is behind a camera. `reference_row`: of the point, for a rolling shutter.
  bool make(const Eigen::Vector2d& pixel, double inverse_depth, PatchPath& path, double reference_row = 0.0) const;

 private:
  struct Moment {
    RigidMotion pose;
    Matrix6 xi_factor;  // right Jacobian of the motion since mid-exposure
  };
  struct Moments {
    Moment start, mid, end;
    RigidMotion carrier;  // T_mid relative to the reference at the time of its row
    double row = 0.0;     // time of the camera's row, in exposures
  };
  static Moment momentAt(const ExposureTrajectory& trajectory, double u);
  Moments momentsAt(double row, double reference_row) const;
  bool makePath(const Moments& moments, const Eigen::Vector2d& pixel, double inverse_depth, PatchPath& path) const;

  PinholeCamera reference_camera_;
  PinholeCamera camera_;
  bool moving_;
  bool rolling_;
  ExposureTrajectory trajectory_;
  BodyMotion reference_motion_;
  Matrix6 first_order_, second_order_;  // J_r(u xi) = I + u (first + u second), for a rolling shutter
  Moments moments_;                     // of the middle rows
};

/// The same for a single patch.
bool makePatchPath(const PinholeCamera& reference_camera, const PinholeCamera& camera,
                   const ExposureTrajectory& trajectory, const Eigen::Vector2d& pixel, double inverse_depth,
                   PatchPath& path);

/// Number of mid-point samples for a path of `length_px`: neighbours are at most `spacing_px` apart, on long paths as
/// many times more as leaves the mean as right; 1 when sharp.
int sampleCount(float length_px, float spacing_px, int max_samples);

}  // namespace mba_vo
