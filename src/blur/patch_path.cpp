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

/// d P / d offset of the blurred pixel, projected: columns are the images of one pixel step to the right and down.
Eigen::Matrix2d warpJacobian(const PinholeCamera& reference_camera, const PinholeCamera& camera,
                             const Eigen::Matrix3d& R, const PlaneHit& hit) {
  const Eigen::Matrix<double, 2, 3> J_projection = reference_camera.projectionJacobian(hit.P);
  // dP = s (I - g e_z^T / g_z) dg
  const auto along = [&](const Eigen::Vector3d& dg) -> Eigen::Vector2d {
    return J_projection * (hit.s * (dg - hit.g * (dg.z() / hit.g.z())));
  };
  Eigen::Matrix2d A;
  A.col(0) = along(R.col(0) / camera.fx);
  A.col(1) = along(R.col(1) / camera.fy);
  return A;
}

PixelTransfer transferFromHit(const PinholeCamera& reference_camera, const Eigen::Matrix3d& R,
                              const Eigen::Vector3d& ray, double inverse_depth, const PlaneHit& hit) {
  PixelTransfer transfer;
  transfer.pixel = reference_camera.project(hit.P);
  const Eigen::Matrix<double, 2, 3> J_projection = reference_camera.projectionJacobian(hit.P);
  Eigen::Matrix<double, 3, 6> J_point;
  J_point << R, -hit.s * R * hat(ray);
  const Eigen::Matrix3d onto_plane = Eigen::Matrix3d::Identity() - hit.g * Eigen::RowVector3d::UnitZ() / hit.g.z();
  transfer.J_pose = J_projection * onto_plane * J_point;
  transfer.J_inverse_depth = J_projection * hit.g * (-1.0 / (hit.g.z() * inverse_depth * inverse_depth));
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
  return transferFromHit(reference_camera, R, ray, inverse_depth, hit);
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
  const PixelTransfer at_mid = transferFromHit(reference_camera_, mid_.R, ray, inverse_depth, mid);
  path.c0 = at_mid.pixel.cast<float>();
  path.c1.setZero();
  path.c2.setZero();
  path.A0 = warpJacobian(reference_camera_, camera_, mid_.R, mid).cast<float>();
  path.A1.setZero();
  path.J_pose = {at_mid.J_pose, Matrix26::Zero()};
  path.J_xi = {at_mid.J_pose, Matrix26::Zero()};
  path.J_inverse_depth = {at_mid.J_inverse_depth, Eigen::Vector2d::Zero()};
  if (!moving_) return true;

  const PlaneHit start = intersectPlane(start_.R, start_.p, ray, depth);
  const PlaneHit end = intersectPlane(end_.R, end_.p, ray, depth);
  if (!start.valid || !end.valid) return false;
  const PixelTransfer at_start = transferFromHit(reference_camera_, start_.R, ray, inverse_depth, start);
  const PixelTransfer at_end = transferFromHit(reference_camera_, end_.R, ray, inverse_depth, end);
  path.c1 = (at_end.pixel - at_start.pixel).cast<float>();
  path.c2 = (2.0 * (at_start.pixel + at_end.pixel) - 4.0 * at_mid.pixel).cast<float>();
  path.A1 = (warpJacobian(reference_camera_, camera_, end_.R, end) -
             warpJacobian(reference_camera_, camera_, start_.R, start))
                .cast<float>();
  path.J_pose[1] = at_end.J_pose * end_.pose_factor - at_start.J_pose * start_.pose_factor;
  const Matrix26 J_xi_start = at_start.J_pose * start_.xi_factor;
  const Matrix26 J_xi_end = at_end.J_pose * end_.xi_factor;
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
