#include "mba_vo/evaluation/consistency.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "mba_vo/evaluation/association.h"
#include "mba_vo/evaluation/statistics.h"
#include "mba_vo/evaluation/true_motion.h"
#include "mba_vo/geometry/angles.h"

namespace mba_vo {
namespace {

/// Motion of the camera since the first pose, in the axes it had then.
struct Motion {
  double time = 0.0;  // of the pose [s]
  SE3 estimated;      // in units of the odometry
  SE3 groundtruth;
};

/// Motions of the poses that have a true one; empty if the first has none.
std::vector<Motion> motionsSinceFirst(const std::vector<PoseRecord>& groundtruth,
                                      const std::vector<PoseRecord>& poses) {
  const std::optional<SE3> first_truth = truePoseAt(groundtruth, poses.front().time);
  std::vector<Motion> motions;
  for (const PoseRecord& pose : poses) {
    const std::optional<SE3> truth = truePoseAt(groundtruth, pose.time);
    if (first_truth && truth) {
      motions.push_back(
          {pose.time, poses.front().T_world_camera.inverse() * pose.T_world_camera, first_truth->inverse() * *truth});
    }
  }
  return motions;
}

/// Least squares of true position - scale * estimated position over the first two seconds; nullopt if they do not tell.
std::optional<double> fitScale(const std::vector<Motion>& motions) {
  constexpr double kDuration = 2.0;  // [s]
  double products = 0.0;
  double squares = 0.0;
  for (const Motion& motion : motions) {
    if (motion.time - motions.front().time <= kDuration) {
      products += motion.groundtruth.translation().dot(motion.estimated.translation());
      squares += motion.estimated.translation().squaredNorm();
    }
  }
  return products > 0.0 && squares > 0.0 ? std::optional<double>(products / squares) : std::nullopt;
}

const Matrix6* covarianceAt(const std::vector<OnlineFrame>& frames, double time) {
  constexpr double kStampTolerance = 1e-5;  // decimals written to files [s]
  const auto found = std::find_if(frames.begin(), frames.end(), [&](const OnlineFrame& frame) {
    return frame.covariance && std::abs(frame.time - time) <= kStampTolerance;
  });
  return found == frames.end() ? nullptr : &*found->covariance;
}

NeesSample unavailable(double after, const std::string& reason) {
  return {after, kNone, kNone, kNone, kNone, kNone, kNone, kNone, reason};
}

NeesSample compare(double after, const Motion& motion, const Matrix6& covariance, double scale) {
  const SE3 estimate(motion.estimated.rotation(), scale * motion.estimated.translation());
  const Vector6 error = (estimate.inverse() * motion.groundtruth).log();
  Matrix6 P = covariance;  // in metres
  P.topRows<3>() *= scale;
  P.leftCols<3>() *= scale;
  const Eigen::LLT<Matrix6> factor(P);
  if (factor.info() != Eigen::Success) {
    return unavailable(after, "the covariance is not positive definite");
  }
  const Eigen::Vector3d rho = error.head<3>();
  const Eigen::Vector3d phi = error.tail<3>();
  NeesSample sample;
  sample.after = after;
  sample.total = error.dot(factor.solve(error)) / 6.0;
  sample.translation = rho.dot(P.topLeftCorner<3, 3>().llt().solve(rho)) / 3.0;
  sample.rotation = phi.dot(P.bottomRightCorner<3, 3>().llt().solve(phi)) / 3.0;
  sample.position_error = (motion.groundtruth.translation() - estimate.translation()).norm();
  sample.position_sigma = std::sqrt(P.topLeftCorner<3, 3>().trace());
  sample.rotation_error = kDegreesPerRadian * phi.norm();
  sample.rotation_sigma = kDegreesPerRadian * std::sqrt(P.bottomRightCorner<3, 3>().trace());
  return sample;
}

NeesSample sampleAt(double after, const std::vector<Motion>& motions, const std::vector<OnlineFrame>& frames,
                    double scale) {
  const double wanted = motions.front().time + after;
  const auto distance = [&](const Motion& motion) { return std::abs(motion.time - wanted); };
  const auto nearest = std::min_element(motions.begin(), motions.end(),
                                        [&](const Motion& a, const Motion& b) { return distance(a) < distance(b); });
  constexpr double kTolerance = 0.1;  // [s]
  if (distance(*nearest) > kTolerance) {
    return unavailable(after, "no pose of this map with a true one within 0.1 s");
  }
  const Matrix6* covariance = covarianceAt(frames, nearest->time);
  return covariance == nullptr ? unavailable(after, "published without covariance")
                               : compare(after, *nearest, *covariance, scale);
}

}  // namespace

Consistency measureConsistency(const std::vector<PoseRecord>& groundtruth, const std::vector<PoseRecord>& odometry,
                               const std::vector<OnlineFrame>& frames, const ConsistencyOptions& options) {
  Consistency consistency;
  consistency.scale = kNone;
  const std::vector<PoseRecord> poses = posesOfLargestMap(odometry);
  const std::vector<Motion> motions = poses.empty() ? std::vector<Motion>() : motionsSinceFirst(groundtruth, poses);
  std::string problem;
  if (poses.empty()) {
    problem = "no pose";
  } else if (motions.empty()) {
    problem = "no true pose for the first one";
  } else {
    consistency.scale = options.fit_scale ? fitScale(motions).value_or(kNone) : 1.0;
    problem = std::isfinite(consistency.scale) ? "" : "no scale: no common motion within the first 2 s";
  }
  if (!poses.empty()) {
    consistency.map = poses.front().map;
    consistency.first_map = odometry.front().map == consistency.map;
  }
  for (const double after : options.times) {
    consistency.samples.push_back(problem.empty() ? sampleAt(after, motions, frames, consistency.scale)
                                                  : unavailable(after, problem));
  }
  return consistency;
}

}  // namespace mba_vo
