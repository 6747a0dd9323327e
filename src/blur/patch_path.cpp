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

PlaneHit intersectPlane(const SE3& T_reference_camera, const Eigen::Vector3d& ray, double depth) {
  PlaneHit hit;
  hit.g = T_reference_camera.rotation() * ray;
  if (hit.g.z() < kMinDepthRatio) return hit;
  hit.s = (depth - T_reference_camera.translation().z()) / hit.g.z();
  if (hit.s < kMinDepthRatio * depth) return hit;
  hit.P = T_reference_camera.translation() + hit.s * hit.g;
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

PixelTransfer transferFromHit(const PinholeCamera& reference_camera, const SE3& T_reference_camera,
                              const Eigen::Vector3d& ray, double inverse_depth, const PlaneHit& hit) {
  PixelTransfer transfer;
  transfer.pixel = reference_camera.project(hit.P);
  const Eigen::Matrix<double, 2, 3> J_projection = reference_camera.projectionJacobian(hit.P);
  const Eigen::Matrix3d R = T_reference_camera.rotationMatrix();
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
  const PlaneHit hit = intersectPlane(T_reference_camera, ray, 1.0 / inverse_depth);
  if (!hit.valid) return {};
  return transferFromHit(reference_camera, T_reference_camera, ray, inverse_depth, hit);
}

float PatchPath::length() const { return c1.norm(); }

bool makePatchPath(const PinholeCamera& reference_camera, const PinholeCamera& camera,
                   const ExposureTrajectory& trajectory, const Eigen::Vector2d& pixel, double inverse_depth,
                   PatchPath& path) {
  if (inverse_depth <= 0.0) return false;
  const Eigen::Vector3d ray = camera.unproject(pixel);
  const double depth = 1.0 / inverse_depth;
  const Vector6 xi = trajectory.xi();
  const bool moving = xi.squaredNorm() > 0.0;

  const PlaneHit mid = intersectPlane(trajectory.T_reference_mid, ray, depth);
  if (!mid.valid) return false;
  const PixelTransfer at_mid = transferFromHit(reference_camera, trajectory.T_reference_mid, ray, inverse_depth, mid);
  path.c0 = at_mid.pixel.cast<float>();
  path.A0 = warpJacobian(reference_camera, camera, trajectory.T_reference_mid.rotationMatrix(), mid).cast<float>();
  path.J_pose = {at_mid.J_pose, Matrix26::Zero()};
  path.J_xi = {at_mid.J_pose, Matrix26::Zero()};
  path.J_inverse_depth = {at_mid.J_inverse_depth, Eigen::Vector2d::Zero()};
  path.c1.setZero();
  path.c2.setZero();
  path.A1.setZero();
  if (!moving) return true;

  Eigen::Vector2d end_pixel[2];
  Eigen::Matrix2d end_A[2];
  Matrix26 end_J_pose[2];
  Matrix26 end_J_xi[2];
  Eigen::Vector2d end_J_depth[2];
  for (int e = 0; e < 2; ++e) {
    const Vector6 half = (e == 0 ? -0.5 : 0.5) * xi;
    const SE3 increment = SE3::exp(half);
    const SE3 T = trajectory.T_reference_mid * increment;
    const PlaneHit hit = intersectPlane(T, ray, depth);
    if (!hit.valid) return false;
    const PixelTransfer transfer = transferFromHit(reference_camera, T, ray, inverse_depth, hit);
    end_pixel[e] = transfer.pixel;
    end_A[e] = warpJacobian(reference_camera, camera, T.rotationMatrix(), hit);
    // The pose at u moves by Ad(Exp(-u xi)) delta + u J_r(u xi) epsilon.
    end_J_pose[e] = transfer.J_pose * increment.inverse().adjoint();
    end_J_xi[e] = transfer.J_pose * rightJacobian(half);
    end_J_depth[e] = transfer.J_inverse_depth;
  }
  path.c1 = (end_pixel[1] - end_pixel[0]).cast<float>();
  path.c2 = (2.0 * (end_pixel[0] + end_pixel[1]) - 4.0 * at_mid.pixel).cast<float>();
  path.A1 = (end_A[1] - end_A[0]).cast<float>();
  path.J_pose[1] = end_J_pose[1] - end_J_pose[0];
  path.J_xi = {0.5 * (end_J_xi[0] + end_J_xi[1]), end_J_xi[1] - end_J_xi[0]};
  path.J_inverse_depth[1] = end_J_depth[1] - end_J_depth[0];
  return true;
}

int sampleCount(float length_px, float spacing_px, int max_samples) {
  return std::clamp(static_cast<int>(std::ceil(length_px / spacing_px)), 1, max_samples);
}

}  // namespace mba_vo
