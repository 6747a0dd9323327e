#include "errors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

namespace mba_vo::study {
namespace {

constexpr int kGrid = 10;            // [px]
constexpr double kNearest = 0.1;     // [m]
constexpr double kPointError = 2.0;  // [px]
constexpr double kPointShare = 0.95;

/// Distance between where two poses see a point of the reference [px]; negative where the frame does not see it.
double reprojectionError(const PinholeCamera& camera, const Eigen::Vector3d& point, const SE3& T_true_reference,
                         const SE3& T_estimated_reference) {
  const Eigen::Vector3d truth = T_true_reference * point;
  const Eigen::Vector3d estimate = T_estimated_reference * point;
  if (truth.z() < kNearest || !camera.contains(camera.project(truth))) return -1.0;
  if (estimate.z() < kNearest) return camera.width;
  return (camera.project(estimate) - camera.project(truth)).norm();
}

double meanReprojectionError(const Case& c, const SE3& T_true_reference, const SE3& T_estimated_reference) {
  const PinholeCamera& camera = c.reference->pyramid->level(0).camera;
  double sum = 0.0;
  int count = 0;
  for (int y = kGrid / 2; y < camera.height; y += kGrid) {
    for (int x = kGrid / 2; x < camera.width; x += kGrid) {
      const Eigen::Vector3d point = static_cast<double>(c.reference_depth(y, x)) * camera.unproject({x, y});
      const double error = reprojectionError(camera, point, T_true_reference, T_estimated_reference);
      if (error < 0.0) continue;
      sum += error;
      ++count;
    }
  }
  return count > 0 ? sum / count : camera.width;
}

bool pointsAreWithin(const Case& c, const SE3& T_true_reference, const SE3& T_estimated_reference) {
  const PinholeCamera& camera = c.reference->pyramid->level(0).camera;
  int seen = 0;
  int near = 0;
  for (const ReferencePoint& p : c.reference->points) {
    const Eigen::Vector3d point = camera.unproject(p.pixel.cast<double>()) / static_cast<double>(p.inverse_depth);
    const double error = reprojectionError(camera, point, T_true_reference, T_estimated_reference);
    seen += error >= 0.0 ? 1 : 0;
    near += error >= 0.0 && error <= kPointError ? 1 : 0;
  }
  return near >= kPointShare * seen;
}

/// Motion within the exposure of points 2 m before the camera along the border of the image [px].
std::vector<Eigen::Vector2d> borderMotion(const PinholeCamera& camera, const SE3& T_start_end) {
  constexpr int kSteps = 8;
  constexpr double kDepth = 2.0;  // [m]
  const SE3 T_end_start = T_start_end.inverse();
  const double right = camera.width - 1.0;
  const double bottom = camera.height - 1.0;
  std::vector<Eigen::Vector2d> motion;
  for (int i = 0; i < kSteps; ++i) {
    const double x = right * i / kSteps;
    const double y = bottom * i / kSteps;
    for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(x, 0.0), Eigen::Vector2d(right, y),
                                         Eigen::Vector2d(right - x, bottom), Eigen::Vector2d(0.0, bottom - y)}) {
      motion.push_back(camera.project(T_end_start * (kDepth * camera.unproject(pixel))) - pixel);
    }
  }
  return motion;
}

double nees(const Vector6& error, const Matrix6& covariance) {
  return error.dot(covariance.ldlt().solve(error)) / static_cast<double>(error.size());
}

void compareMotion(const PinholeCamera& camera, const SE3& truth, const SE3& estimate, Errors& errors,
                   double& true_length) {
  const auto true_motion = borderMotion(camera, truth);
  const auto motion = borderMotion(camera, estimate);
  const auto count = static_cast<double>(motion.size());
  double dot = 0.0;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    errors.motion_px += (motion[i] - true_motion[i]).norm() / count;
    true_length += true_motion[i].norm() / count;
    dot += motion[i].dot(true_motion[i]);
  }
  errors.sign_right = dot > 0.0;
}

}  // namespace

Errors compare(const Case& truth, const TrackedFrame& tracked) {
  constexpr double kConvergedMid = 1.0;     // [px]
  constexpr double kConvergedMotion = 1.5;  // [px]
  constexpr double kConvergedMotionPart = 0.1;
  const SE3& estimate = tracked.trajectory.T_reference_mid;
  const SE3 T_true_reference = truth.T_reference_mid.inverse();
  Errors errors;
  errors.tracking = tracked.status == TrackingStatus::kTracking;
  errors.mid_px = meanReprojectionError(truth, T_true_reference, estimate.inverse());
  errors.points_within_2px = pointsAreWithin(truth, T_true_reference, estimate.inverse());
  double true_length = 0.0;
  compareMotion(truth.reference->pyramid->level(0).camera, truth.T_start_end, SE3::exp(tracked.trajectory.xi()), errors,
                true_length);
  errors.converged = tracked.tracked() && errors.mid_px < kConvergedMid &&
                     errors.motion_px < std::max(kConvergedMotion, kConvergedMotionPart * true_length);
  errors.pose_nees = nees((estimate.inverse() * truth.T_reference_mid).log(), tracked.covariance.topLeftCorner<6, 6>());
  errors.xi_nees =
      nees(truth.T_start_end.log() - tracked.trajectory.xi(), tracked.covariance.bottomRightCorner<6, 6>());
  return errors;
}

}  // namespace mba_vo::study
