#include "mba_vo/tracking/expected_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mba_vo {
namespace {

constexpr double kShare = 0.95;  // of the points

using Matrix23 = Eigen::Matrix<double, 2, 3>;
using Matrix36 = Eigen::Matrix<double, 3, 6>;

/// d pixel / d point in the camera.
Matrix23 projectionJacobian(const PinholeCamera& camera, const Eigen::Vector3d& point) {
  const double w = 1.0 / point.z();
  Matrix23 J;
  J << camera.fx * w, 0.0, -camera.fx * point.x() * w * w,  //
      0.0, camera.fy * w, -camera.fy * point.y() * w * w;
  return J;
}

}  // namespace

double expectedPixelError(const Reference& reference, const SE3& T_reference_frame, const Matrix6& pose_covariance) {
  const PinholeCamera& camera = reference.pyramid->level(0).camera;
  const SE3 T_frame_reference = T_reference_frame.inverse();
  std::vector<double> variances;
  for (const ReferencePoint& p : reference.points) {
    const Eigen::Vector3d in_reference =
        camera.unproject(p.pixel.cast<double>()) / static_cast<double>(p.inverse_depth);
    const Eigen::Vector3d point = T_frame_reference * in_reference;
    if (point.z() <= 0.0 || !camera.contains(camera.project(point))) continue;
    Matrix36 J_pose;  // of the point: the camera moves by (rho, phi) along its own axes
    J_pose << -Eigen::Matrix3d::Identity(), hat(point);
    const Eigen::Matrix<double, 2, 6> J = projectionJacobian(camera, point) * J_pose;
    variances.push_back((J * pose_covariance * J.transpose()).trace());
  }
  if (variances.empty()) return 0.0;
  const auto at = variances.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(variances.size() - 1));
  std::nth_element(variances.begin(), at, variances.end());
  return std::sqrt(*at);
}

}  // namespace mba_vo
