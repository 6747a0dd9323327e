#include "tracker_job.h"

#include <algorithm>
#include <cmath>

#include "mba_vo/tracking/frame_measures.h"
#include "mba_vo/tracking/point_subset.h"

namespace mba_vo {
namespace {

constexpr double kLeastBlurToSeed = 0.5;      // [px] shorter motion gives no direction to descend along
constexpr double kLargestAcceleration = 3.0;  // standard deviations of the motion prior
constexpr double kShortestExposure = 1e-4;    // [s] a rolling shutter tells the velocity even if nothing is blurred
// Of log exposure that nobody told: it changes by so much unseen (docs/decisions/2026-11-27-first-exposure.md).
constexpr double kLeastUntold = 0.4;
// What the rows of a rolling shutter leave open, a turn against a way and both against how they change
// (docs/decisions/2026-11-28-rolling-shutters.md).
constexpr double kRowsLinearAcceleration = 2.0;   // standard deviation [median depths/s^2]
constexpr double kRowsAngularAcceleration = 4.0;  // the same, of what is expected by the velocities [rad/s^2]

}  // namespace

Tracker::Job::Job(const Reference& r, const Frame& f, const TrackingGuess& g, int levels, int max_points)
    : reference(r),
      frame(f),
      guess(g),
      rolling(f.pyramid.level(0).camera.row_time != 0.0),
      exposure(rolling ? std::max(g.trajectory.exposure, kShortestExposure) : g.trajectory.exposure),
      median_depth(medianDepth(r)) {
  for (int level = 0; level < levels; ++level) {
    points.push_back(selectEvenSubset(r, level, patchSide(level), max_points));
  }
}

double Tracker::Job::untold() const {
  if (frame.exposureWasTold()) return 0.0;
  if (!frame.exposure) return kAssumedExposureSigma;
  return std::clamp(frame.exposure_log_sigma, kLeastUntold, kAssumedExposureSigma);
}

double Tracker::Job::exposureOf(const AlignmentState& state) const { return exposure * std::exp(state.log_exposure); }

Vector6 Tracker::Job::seeded(const Vector6& xi) const {
  if (rolling || fx() * xi.tail<3>().norm() >= kLeastBlurToSeed) return xi;
  Vector6 seed = xi;
  seed(4) += kLeastBlurToSeed / fx();
  return seed;
}

double Tracker::Job::turn(const AlignmentState& l, const AlignmentState& r) const {
  const SE3 between = l.T_reference_mid.inverse() * r.T_reference_mid;
  return fx() * between.log().tail<3>().norm();
}

std::optional<AlignmentPrior> Tracker::priorFor(const Job& job, const AlignmentState& state) const {
  const auto& motion = job.guess.motion;
  if (!motion || motion->dt == 0.0) return std::nullopt;
  const double exposure = job.exposure;
  AlignmentPrior prior;
  prior.T_reference_mid = motion->predict(exposure).T_reference_mid;
  prior.pose_information = motion->poseInformation(config_.motion_prior, job.median_depth);
  if (exposure == 0.0) return prior;
  MotionPriorConfig within = config_.motion_prior;
  if (job.rolling) {
    within.linear_acceleration = std::min(within.linear_acceleration, kRowsLinearAcceleration);
    const double sigma = exposure * exposure * kRowsAngularAcceleration;
    prior.turn_bend = bendFor(job, state).tail<3>() * std::exp(-2.0 * state.log_exposure);
    prior.turn_bend_information.setConstant(1.0 / (sigma * sigma));
    const double untold = config_.estimate_exposure ? job.untold() : 0.0;
    if (untold > 0.0) prior.log_exposure_information = 1.0 / (untold * untold);
  }
  prior.xi = motion->expectedXi(state.T_reference_mid, exposure);
  const double doubt = job.rolling ? 0.0 : job.untold();  // rows tell a velocity without an exposure
  prior.xi_information = motion->xiInformation(within, job.median_depth, exposure, doubt * prior.xi);
  return prior;
}

Vector6 Tracker::bendFor(const Job& job, const AlignmentState& state) const {
  const auto& motion = job.guess.motion;
  const double exposure = job.exposureOf(state);
  // Without the true exposure, the motion within it and that between the frames cannot be compared, but for rows.
  const bool comparable = exposure > 0.0 && (job.rolling || job.untold() == 0.0);
  if (!motion || motion->dt == 0.0 || !comparable) return Vector6::Zero();
  const double limit = kLargestAcceleration * exposure * exposure;
  const Vector6 bend = motion->bend(state.T_reference_mid, state.xi, exposure);
  Vector6 largest;
  largest.head<3>().setConstant(limit * config_.motion_prior.linear_acceleration * job.median_depth);
  largest.tail<3>().setConstant(limit * config_.motion_prior.angular_acceleration);
  return bend.cwiseMax(-largest).cwiseMin(largest);
}

}  // namespace mba_vo
