#include "mba_vo/trajectory/pose_interpolation.h"

#include <Eigen/Cholesky>

namespace mba_vo {
namespace {

double secondsBetween(std::int64_t from_ns, std::int64_t to_ns) { return 1e-9 * static_cast<double>(to_ns - from_ns); }

Matrix6 covarianceOfDifference(Matrix6 covariance, const Vector6& sigma) {
  covariance.diagonal() += sigma.cwiseAbs2();
  return covariance;
}

}  // namespace

StampedPose interpolatePose(const StampedPose& before, const StampedPose& after, std::int64_t mid_exposure_ns) {
  const double interval = secondsBetween(before.mid_exposure_ns, after.mid_exposure_ns);
  const double since = secondsBetween(before.mid_exposure_ns, mid_exposure_ns);
  const double until = interval - since;
  const Vector6 half_acceleration = 0.5 / interval * (after.velocity - before.velocity);
  const SE3 forwards = before.T_map_camera * SE3::exp(since * before.velocity + since * since * half_acceleration);
  const SE3 backwards = after.T_map_camera * SE3::exp(-until * after.velocity + until * until * half_acceleration);
  const double s = since / interval;
  const SE3 T_map_camera = forwards * SE3::exp(s * s * (3.0 - 2.0 * s) * (forwards.inverse() * backwards).log());
  return {mid_exposure_ns, T_map_camera, (1.0 - s) * before.velocity + s * after.velocity};
}

Vector6 velocityByPoses(const StampedPose& before, const StampedPose& at, const StampedPose& after) {
  const double since = secondsBetween(before.mid_exposure_ns, at.mid_exposure_ns);
  const double until = secondsBetween(at.mid_exposure_ns, after.mid_exposure_ns);
  const Vector6 until_here = (before.T_map_camera.inverse() * at.T_map_camera).log() / since;
  const Vector6 from_here = (at.T_map_camera.inverse() * after.T_map_camera).log() / until;
  return (until * until_here + since * from_here) / (since + until);
}

double squaredMahalanobisDistance(const SE3& T, const Matrix6& covariance, const SE3& T_other, const Vector6& sigma) {
  const Vector6 difference = (T.inverse() * T_other).log();
  return difference.dot(covarianceOfDifference(covariance, sigma).ldlt().solve(difference));
}

SE3 fusedPose(const SE3& T, const Matrix6& covariance, const SE3& T_other, const Vector6& sigma) {
  const Vector6 difference = (T.inverse() * T_other).log();
  return T * SE3::exp(covariance * covarianceOfDifference(covariance, sigma).ldlt().solve(difference));
}

}  // namespace mba_vo
