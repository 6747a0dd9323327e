#include "mba_vo/blur/patch_path.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

constexpr double kMinDepthRatio = 1e-3;  // points closer than this fraction of the plane's depth are behind the camera

/// Everything about looking from one pose of the camera through a pixel onto the plane z = d of the reference.
struct PlaneHit {
  bool valid = false;
  Eigen::Vector3d g;  // ray in the reference frame
  Eigen::Vector3d P;  // point in the reference frame [m]
  double s = 0.0;     // P = p + s g
};

PlaneHit intersectPlane(const Eigen::Matrix3d& R, const Eigen::Vector3d& p, const Eigen::Vector3d& ray, double depth) {
  PlaneHit hit;
  hit.g = R * ray;
  if (hit.g.z() < kMinDepthRatio) return hit;
  hit.s = (depth - p.z()) / hit.g.z();
  if (hit.s < kMinDepthRatio * depth) return hit;
  hit.P = p + hit.s * hit.g;
  hit.valid = true;
  return hit;
}

/// Derivative of the pixel in the reference for a shift of the camera, in camera axes: dP = (I - g e_z^T / g_z) R drho.
using ShiftJacobian = Eigen::Matrix<double, 2, 3>;

ShiftJacobian shiftJacobian(const PinholeCamera& reference_camera, const Eigen::Matrix3d& R, const PlaneHit& hit) {
  const Eigen::Matrix<double, 2, 3> J_projection = reference_camera.projectionJacobian(hit.P);
  const Eigen::Vector2d along_ray = J_projection.lazyProduct(hit.g) / hit.g.z();
  Eigen::Matrix<double, 2, 3> onto_plane = J_projection;
  onto_plane.col(2) -= along_ray;
  return onto_plane.lazyProduct(R);
}

/// Columns are the images of one pixel step to the right and down: the ray turns by R e / f, P moves by s times that.
Eigen::Matrix2f warpJacobian(const PinholeCamera& camera, const ShiftJacobian& J_shift, double s) {
  Eigen::Matrix2d A;
  A << J_shift.col(0) * (s / camera.fx), J_shift.col(1) * (s / camera.fy);
  return A.cast<float>();
}

PixelTransfer transferFromHit(const PinholeCamera& reference_camera, const ShiftJacobian& J_shift,
                              const Eigen::Vector3d& ray, double inverse_depth, const PlaneHit& hit) {
  PixelTransfer transfer;
  transfer.pixel = reference_camera.project(hit.P);
  transfer.J_pose.leftCols<3>() = J_shift;
  // -s J_shift [ray]_x, row by row: v^T [r]_x = -(r x v)^T.
  for (int row = 0; row < 2; ++row) {
    transfer.J_pose.block<1, 3>(row, 3) = hit.s * ray.cross(J_shift.row(row).transpose()).transpose();
  }
  const Eigen::Vector2d along_ray = reference_camera.projectionJacobian(hit.P).lazyProduct(hit.g) / hit.g.z();
  transfer.J_inverse_depth = along_ray / (-inverse_depth * inverse_depth);
  transfer.valid = true;
  return transfer;
}

}  // namespace

PixelTransfer transferPixel(const PinholeCamera& reference_camera, const PinholeCamera& camera,
                            const SE3& T_reference_camera, const Eigen::Vector2d& pixel, double inverse_depth) {
  const Eigen::Vector3d ray = camera.unproject(pixel);
  const Eigen::Matrix3d R = T_reference_camera.rotationMatrix();
  const PlaneHit hit = intersectPlane(R, T_reference_camera.translation(), ray, 1.0 / inverse_depth);
  if (!hit.valid) return {};
  return transferFromHit(reference_camera, shiftJacobian(reference_camera, R, hit), ray, inverse_depth, hit);
}

float PatchPath::length() const { return c1.norm(); }

PatchPathMaker::Moment PatchPathMaker::momentAt(const ExposureTrajectory& trajectory, double u) {
  const Vector6 motion = u * trajectory.xi();
  const SE3 increment = SE3::exp(motion);
  const SE3 T = trajectory.T_reference_mid * increment;
  // The pose at u moves by Ad(Exp(-u xi)) delta + u J_r(u xi) epsilon.
  return {T.rotationMatrix(), T.translation(), increment.inverse().adjoint(), rightJacobian(motion)};
}

PatchPathMaker::PatchPathMaker(const PinholeCamera& reference_camera, const PinholeCamera& camera,
                               const ExposureTrajectory& trajectory)
    : reference_camera_(reference_camera),
      camera_(camera),
      moving_(trajectory.xi().squaredNorm() > 0.0),
      start_(momentAt(trajectory, -0.5)),
      mid_(momentAt(trajectory, 0.0)),
      end_(momentAt(trajectory, 0.5)) {}

bool PatchPathMaker::make(const Eigen::Vector2d& pixel, double inverse_depth, PatchPath& path) const {
  if (inverse_depth <= 0.0) return false;
  const Eigen::Vector3d ray = camera_.unproject(pixel);
  const double depth = 1.0 / inverse_depth;
  const PlaneHit mid = intersectPlane(mid_.R, mid_.p, ray, depth);
  if (!mid.valid) return false;
  const ShiftJacobian J_mid = shiftJacobian(reference_camera_, mid_.R, mid);
  const PixelTransfer at_mid = transferFromHit(reference_camera_, J_mid, ray, inverse_depth, mid);
  path.c0 = at_mid.pixel.cast<float>();
  path.c1.setZero();
  path.c2.setZero();
  path.A0 = warpJacobian(camera_, J_mid, mid.s);
  path.A1.setZero();
  path.J_pose = {at_mid.J_pose, Matrix26::Zero()};
  path.J_xi = {at_mid.J_pose, Matrix26::Zero()};
  path.J_inverse_depth = {at_mid.J_inverse_depth, Eigen::Vector2d::Zero()};
  if (!moving_) return true;

  const PlaneHit start = intersectPlane(start_.R, start_.p, ray, depth);
  const PlaneHit end = intersectPlane(end_.R, end_.p, ray, depth);
  if (!start.valid || !end.valid) return false;
  const ShiftJacobian J_start = shiftJacobian(reference_camera_, start_.R, start);
  const ShiftJacobian J_end = shiftJacobian(reference_camera_, end_.R, end);
  const PixelTransfer at_start = transferFromHit(reference_camera_, J_start, ray, inverse_depth, start);
  const PixelTransfer at_end = transferFromHit(reference_camera_, J_end, ray, inverse_depth, end);
  path.c1 = (at_end.pixel - at_start.pixel).cast<float>();
  path.c2 = (2.0 * (at_start.pixel + at_end.pixel) - 4.0 * at_mid.pixel).cast<float>();
  path.A1 = warpJacobian(camera_, J_end, end.s) - warpJacobian(camera_, J_start, start.s);
  path.J_pose[1] = at_end.J_pose.lazyProduct(end_.pose_factor) - at_start.J_pose.lazyProduct(start_.pose_factor);
  const Matrix26 J_xi_start = at_start.J_pose.lazyProduct(start_.xi_factor);
  const Matrix26 J_xi_end = at_end.J_pose.lazyProduct(end_.xi_factor);
  path.J_xi = {0.5 * (J_xi_start + J_xi_end), J_xi_end - J_xi_start};
  path.J_inverse_depth[1] = at_end.J_inverse_depth - at_start.J_inverse_depth;
  return true;
}

bool makePatchPath(const PinholeCamera& reference_camera, const PinholeCamera& camera,
                   const ExposureTrajectory& trajectory, const Eigen::Vector2d& pixel, double inverse_depth,
                   PatchPath& path) {
  return PatchPathMaker(reference_camera, camera, trajectory).make(pixel, inverse_depth, path);
}

int sampleCount(float length_px, float spacing_px, int max_samples) {
  return std::clamp(static_cast<int>(std::ceil(length_px / spacing_px)), 1, max_samples);
}

}  // namespace mba_vo
