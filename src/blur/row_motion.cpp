#include "mba_vo/blur/row_motion.h"

namespace mba_vo {

RigidMotion shortMotion(const Vector6& xi) {
  const Eigen::Vector3d w = xi.tail<3>();
  const Eigen::Vector3d rho = xi.head<3>();
  const Eigen::Matrix3d W = hat(w);
  const Eigen::Matrix3d W2 = W.lazyProduct(W);
  const double w2 = w.squaredNorm();
  const double cosine_part = 0.5 - w2 / 24.0;  // (1 - cos) / w^2
  return {Eigen::Matrix3d::Identity() + (1.0 - w2 / 6.0) * W + cosine_part * W2,
          rho + cosine_part * w.cross(rho) + W2.lazyProduct(rho) / 6.0};
}

std::optional<RollingProjection> projectRolling(const PinholeCamera& camera, const Vector6& velocity,
                                                const Eigen::Vector3d& point) {
  constexpr int kIterations = 4;  // an error of the row shrinks by row_time times the speed of the image, at most 0.1
  Eigen::Vector3d seen = point;
  for (int i = 0; i < kIterations && seen.z() > 0.0; ++i) {
    const RigidMotion back = shortMotion(velocity, -camera.rowDelay(camera.project(seen).y()));
    seen = back.R * point + back.p;
  }
  if (seen.z() <= 0.0) return std::nullopt;
  return RollingProjection{camera.project(seen), seen.z()};
}

}  // namespace mba_vo
