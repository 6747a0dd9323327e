#include "mba_vo/blur/fixed_motion_path.h"

namespace mba_vo {
namespace {

constexpr double kMinFixedDepthRatio = 1e-3;  // as in PatchPathMaker

bool isRolling(const PinholeCamera& camera, const BodyMotion& motion) {
  return camera.row_time != 0.0 && !motion.velocity.isZero(0.0);
}

}  // namespace

/// Where a ray of the camera meets the plane z = 1 / w of the reference, w the inverse depth. With g = R r = g_z (a, b,
/// 1) the point is w P = w p + (1 - w p_z) (a, b, 1): everything is linear in w.
struct FixedMotionPathMaker::Hit {
  Eigen::Vector2d pixel;            // in the reference [px]
  Eigen::Matrix2d A;                // d pixel / d pixel of the camera
  Eigen::Vector2d J_inverse_depth;  // [px m]
  double a = 0.0, b = 0.0;
  Eigen::Vector3d wP;
};

FixedMotionPathMaker::FixedMotionPathMaker(const PinholeCamera& reference_camera, const PinholeCamera& camera,
                                           const ExposureTrajectory& trajectory, const RowMotion& rows)
    : reference_camera_(reference_camera),
      camera_(camera),
      moving_(trajectory.xi().squaredNorm() > 0.0),
      rolling_(isRolling(camera, rows.camera) || isRolling(reference_camera, rows.reference)),
      to_reference_row_(RigidMotion(), {-rows.reference.velocity, -rows.reference.acceleration}),
      T_reference_camera_(RigidMotion(trajectory.T_reference_mid), rows.camera) {
  if (moving_) {
    const double half = 0.5 * trajectory.exposure;
    to_start_ = RigidMotion(SE3::exp(trajectory.motionUntil(-half)));
    to_end_ = RigidMotion(SE3::exp(trajectory.motionUntil(half)));
  }
  moments_ = momentsAround(RigidMotion(trajectory.T_reference_mid));
}

/// The motion within the exposure is the same for all rows.
FixedMotionPathMaker::Moments FixedMotionPathMaker::momentsAround(const RigidMotion& mid) const {
  return moving_ ? Moments{mid * to_start_, mid, mid * to_end_} : Moments{mid, mid, mid};
}

FixedMotionPathMaker::Moments FixedMotionPathMaker::momentsAt(double row, double reference_row) const {
  const RigidMotion to_reference_row = to_reference_row_.at(reference_camera_.rowDelay(reference_row));
  return momentsAround(to_reference_row * T_reference_camera_.at(camera_.rowDelay(row)));
}

RigidMotion FixedMotionPathMaker::carrierAt(double reference_row) const {
  return to_reference_row_.at(reference_camera_.rowDelay(reference_row)) * moments_.mid;
}

bool FixedMotionPathMaker::hit(const RigidMotion& moment, const Eigen::Vector3d& ray, double inverse_depth,
                               Hit& hit) const {
  const Eigen::Matrix3d& R = moment.R;
  const Eigen::Vector3d& p = moment.p;
  const Eigen::Vector3d g = R.lazyProduct(ray);
  if (g.z() < kMinFixedDepthRatio) return false;
  const double inverse_gz = 1.0 / g.z();
  const double remaining = 1.0 - inverse_depth * p.z();  // share of the plane's depth in front of the camera
  const double scale = remaining * inverse_gz;
  if (scale < kMinFixedDepthRatio) return false;
  const double a = g.x() * inverse_gz;
  const double b = g.y() * inverse_gz;
  const double fx = reference_camera_.fx;
  const double fy = reference_camera_.fy;
  hit.a = a;
  hit.b = b;
  hit.wP << inverse_depth * p.x() + remaining * a, inverse_depth * p.y() + remaining * b, 1.0;
  hit.pixel << fx * hit.wP.x() + reference_camera_.cx, fy * hit.wP.y() + reference_camera_.cy;
  hit.J_inverse_depth << fx * (p.x() - p.z() * a), fy * (p.y() - p.z() * b);
  const double right = scale / camera_.fx;
  const double down = scale / camera_.fy;
  hit.A << fx * right * (R(0, 0) - a * R(2, 0)), fx * down * (R(0, 1) - a * R(2, 1)),
      fy * right * (R(1, 0) - b * R(2, 0)), fy * down * (R(1, 1) - b * R(2, 1));
  return true;
}

/// For an increment (rho, phi) of the pose at mid-exposure the point moves rigidly by R_mid (rho + phi x X), X its
/// place in that camera, and then along its ray back onto the plane: d pixel = f w [1 0 -a] R_mid (rho + phi x X).
Matrix26 FixedMotionPathMaker::poseJacobian(const RigidMotion& carrier, const Hit& hit, double inverse_depth) const {
  const Eigen::Matrix3d& R = carrier.R;
  const Eigen::Vector3d wX = R.transpose().lazyProduct(hit.wP - inverse_depth * carrier.p);
  const Eigen::Vector3d vx = reference_camera_.fx * (R.row(0) - hit.a * R.row(2)).transpose();
  const Eigen::Vector3d vy = reference_camera_.fy * (R.row(1) - hit.b * R.row(2)).transpose();
  Matrix26 J;
  J << inverse_depth * vx.transpose(), wX.cross(vx).transpose(), inverse_depth * vy.transpose(),
      wX.cross(vy).transpose();
  return J;
}

bool FixedMotionPathMaker::makePath(const Moments& moments, const RigidMotion* carrier, const Eigen::Vector2d& pixel,
                                    double inverse_depth, PatchPath& path) const {
  if (inverse_depth <= 0.0) return false;
  const Eigen::Vector3d ray = camera_.unproject(pixel);
  Hit mid;
  if (!hit(moments.mid, ray, inverse_depth, mid)) return false;
  path.c0 = mid.pixel.cast<float>();
  path.A0 = mid.A.cast<float>();
  path.J_inverse_depth[0] = mid.J_inverse_depth;
  if (carrier) path.J_pose[0] = poseJacobian(*carrier, mid, inverse_depth);
  if (!moving_) {
    path.c1.setZero();
    path.c2.setZero();
    path.A1.setZero();
    path.J_inverse_depth[1].setZero();
    if (carrier) path.J_pose[1].setZero();
    return true;
  }
  Hit start;
  Hit end;
  if (!hit(moments.start, ray, inverse_depth, start) || !hit(moments.end, ray, inverse_depth, end)) return false;
  path.c1 = (end.pixel - start.pixel).cast<float>();
  path.c2 = (2.0 * (start.pixel + end.pixel) - 4.0 * mid.pixel).cast<float>();
  path.A1 = (end.A - start.A).cast<float>();
  path.J_inverse_depth[1] = end.J_inverse_depth - start.J_inverse_depth;
  if (carrier) {
    path.J_pose[1] = poseJacobian(*carrier, end, inverse_depth) - poseJacobian(*carrier, start, inverse_depth);
  }
  return true;
}

bool FixedMotionPathMaker::make(const Eigen::Vector2d& pixel, double inverse_depth, PatchPath& path,
                                double reference_row) const {
  if (!rolling_) return makePath(moments_, &moments_.mid, pixel, inverse_depth, path);
  const RigidMotion carrier = carrierAt(reference_row);
  return makePath(momentsAt(pixel.y(), reference_row), &carrier, pixel, inverse_depth, path);
}

bool FixedMotionPathMaker::makeWithoutPose(const Eigen::Vector2d& pixel, double inverse_depth, PatchPath& path,
                                           double reference_row) const {
  if (!rolling_) return makePath(moments_, nullptr, pixel, inverse_depth, path);
  return makePath(momentsAt(pixel.y(), reference_row), nullptr, pixel, inverse_depth, path);
}

}  // namespace mba_vo
