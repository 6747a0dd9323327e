#include "mba_vo/tracking/tracker.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "mba_vo/solver/levenberg_marquardt.h"
#include "mba_vo/tracking/expected_error.h"
#include "mba_vo/tracking/exposure_by_rows.h"
#include "mba_vo/tracking/frame_measures.h"
#include "tracker_job.h"

namespace mba_vo {
namespace {

constexpr int kStartIterations = 6;  // spent on each alternative start on the coarsest level
constexpr int kCloseLevel = 1;       // the coarsest for a guess that is close
// Steps after which a level is done: each takes off two thirds of what is left, and a finer level has a basin of pixels
// (docs/decisions/2026-11-26-fewer-evaluations.md).
constexpr double kLastStep = 0.03;          // [px] on the finest level
constexpr double kLastCoarseStep = 0.1;     // [px of the level] on others
constexpr int kComparedLevels = 2;          // the coarsest: on them starts are compared, far from where they lead
constexpr int kTurnIterations = 30;         // on the search for a turn
constexpr std::size_t kFinerStarts = 3;     // compared again on the next level
constexpr double kSameBasin = 0.25;         // [px of the coarsest level] results nearer than this are one
constexpr double kObservableBlur = 3.0;     // [px] below it the covariance of xi means nothing
constexpr double kCommonPoseError = 0.015;  // [px] std. deviation of what all patches have wrong alike, as
constexpr double kCommonXiError = 0.1;      // interpolation does; found with bench/tracking_study
constexpr double kRelativeXiError = 0.006;  // of the blur: the motion of a long path is not quite what is modelled
constexpr double kFollowResiduals = 0.0;    // in place of a Huber threshold: one that suits them

}  // namespace

struct Tracker::LevelResult {
  LevenbergMarquardtSummary<AlignmentState, AlignmentProblem::Equations> minimum;
  int patches = 0;
  double huber_threshold = 0.0;  // [grey levels]
  double meanCost() const { return patches > 0 ? minimum.equations.cost / patches : 1e30; }
};

/// `huber_threshold`: or kFollowResiduals.
Tracker::LevelResult Tracker::align(const Job& job, int level, const AlignmentState& initial, int max_iterations,
                                    double huber_threshold, Freedom freedom) const {
  const PatchPattern pattern = PatchPattern::square(Job::patchSide(level));
  AlignmentOptions options;
  options.huber_threshold = config_.huber_threshold;
  options.sample_spacing_px = config_.sample_spacing_px;
  options.max_samples = config_.max_samples;
  options.estimate_xi = job.exposure > 0.0;
  options.exposure = job.exposure;
  options.rotation_only = job.reference.at_infinity || freedom == Freedom::kRotation;
  options.with_covariance = level == 0;
  const std::optional<AlignmentPrior> prior = freedom == Freedom::kRotation ? std::nullopt : priorFor(job, initial);
  options.estimate_turn_bend = job.rolling && prior;
  options.estimate_exposure = prior && prior->log_exposure_information > 0.0;
  AlignmentProblem problem(job.reference, job.points[static_cast<std::size_t>(level)], job.frame, level, pattern,
                           options, prior, initial);
  if (huber_threshold > 0.0) {
    problem.setHuberThreshold(huber_threshold);
  } else {
    problem.followResiduals(initial);
  }
  LevenbergMarquardtOptions lm;
  lm.max_iterations = max_iterations;
  const bool compared = level + kComparedLevels >= static_cast<int>(job.points.size());
  if (!compared) lm.last_step = level == 0 ? kLastStep : kLastCoarseStep;
  lm.promised_decrease = lm.relative_decrease;
  return {minimize(problem, initial, lm), problem.patches(), problem.huberThreshold()};
}

std::vector<AlignmentState> Tracker::starts(const Job& job) const {
  const TrackingGuess& guess = job.guess;
  AlignmentState first;
  first.T_reference_mid = guess.trajectory.T_reference_mid;
  if (job.exposure > 0.0) first.xi = job.seeded(job.exposure * guess.trajectory.velocity);
  first.a = guess.brightness.a - job.reference.brightness.a;
  first.b = guess.brightness.b - std::exp(first.a) * job.reference.brightness.b;
  std::vector<AlignmentState> starts = {first};
  if (!guess.motion || guess.motion->dt == 0.0) return starts;
  for (const SE3& pose : guess.motion->alternatives()) starts.push_back(startAt(job, first, pose));
  return starts;
}

/// The start at another pose, with the motion within the exposure that it would mean.
AlignmentState Tracker::startAt(const Job& job, AlignmentState start, const SE3& pose) {
  start.T_reference_mid = pose;
  if (job.exposure > 0.0) start.xi = job.seeded(job.guess.motion->expectedXi(pose, job.exposure));
  return start;
}

/// A turn alone since the previous frame, whatever was predicted: as patches all over the image tell. With no more to
/// find, it is found from farther away.
AlignmentState Tracker::turned(const Job& job, int level, AlignmentState start) const {
  start.T_reference_mid = job.guess.motion->previous.T_reference_mid;
  const auto turn = align(job, level, start, kTurnIterations, config_.huber_threshold, Freedom::kRotation);
  return startAt(job, start, turn.minimum.state.T_reference_mid);
}

AlignmentState Tracker::bestStart(const Job& job, int level) const {
  std::vector<LevelResult> coarse;
  const auto tryFrom = [&](const AlignmentState& start) {
    coarse.push_back(align(job, level, start, kStartIterations, config_.huber_threshold));
  };
  const std::vector<AlignmentState> predicted = starts(job);
  std::for_each(predicted.begin(), predicted.end(), tryFrom);
  const auto better = [](const auto& l, const auto& r) { return l.meanCost() < r.meanCost(); };
  const auto& best = std::min_element(coarse.begin(), coarse.end(), better)->minimum.equations.statistics;
  const bool surprised = best.inlier_fraction < config_.degraded_inlier_fraction;
  if (surprised && predicted.size() > 1) tryFrom(turned(job, level, predicted.front()));
  std::sort(coarse.begin(), coarse.end(), better);
  // The coarsest level tells little: the best few that differ there are compared again one level finer.
  const double same_basin = kSameBasin * (1 << level);
  std::vector<const LevelResult*> candidates;
  for (const LevelResult& result : coarse) {
    if (candidates.size() >= kFinerStarts || result.patches < coarse.front().patches / 2) continue;
    const auto same = [&](const LevelResult* other) {
      return job.turn(other->minimum.state, result.minimum.state) < same_basin;
    };
    if (std::none_of(candidates.begin(), candidates.end(), same)) candidates.push_back(&result);
  }
  if (candidates.size() == 1) return candidates.front()->minimum.state;
  std::vector<LevelResult> finer;
  for (const LevelResult* candidate : candidates) {
    const AlignmentState& start = candidate->minimum.state;
    finer.push_back(align(job, std::max(level - 1, 0), start, kStartIterations, config_.huber_threshold));
  }
  return std::min_element(finer.begin(), finer.end(), better)->minimum.state;
}

Tracker::LevelResult Tracker::preferExpectedDirection(const Job& job, const LevelResult& result) const {
  // The blurred image hardly tells xi from -xi; continuity with the previous frame does.
  const auto prior = priorFor(job, result.minimum.state);
  if (!prior || job.exposure <= 0.0) return result;
  const Vector6& xi = result.minimum.state.xi;
  if (xi.dot(prior->xi_information.cwiseProduct(prior->xi)) >= 0.0) return result;
  AlignmentState reversed = result.minimum.state;
  reversed.xi = -xi;
  reversed.bend = bendFor(job, reversed);
  const LevelResult other = align(job, 0, reversed, config_.max_iterations, result.huber_threshold);
  const bool same_data = other.patches >= result.patches - result.patches / 20;
  return same_data && other.meanCost() < result.meanCost() ? other : result;
}

Matrix12 Tracker::covarianceOf(const Job& job, const LevelResult& result, double blur_px) const {
  Matrix12 covariance = result.minimum.equations.covariance().topLeftCorner<12, 12>();
  // No patch tells what is wrong in all of them, nor how much the acceleration differs from what was taken for it. A
  // bend shifts the mean of the exposure by 1/24, and so does the bend over the time that a rolling shutter reads rows,
  // over which it tells the velocity too.
  const double fx = job.reference.pyramid->level(0).camera.fx;
  const double exposure = job.exposure;
  const PinholeCamera& camera = job.frame.pyramid.level(0).camera;
  const double readout = std::abs(camera.row_time) * camera.height;
  const double shift = (exposure * exposure + readout * readout) / 24.0;
  const auto variance = [&](double common, double unknown_shift, double unit) {
    const double error = common * unit / fx;
    return error * error + unknown_shift * unknown_shift;
  };
  const MotionPriorConfig& prior = config_.motion_prior;
  auto diagonal = covariance.diagonal();
  diagonal.segment<3>(0).array() +=
      variance(kCommonPoseError, shift * prior.linear_acceleration * job.median_depth, job.median_depth);
  diagonal.segment<3>(3).array() += variance(kCommonPoseError, shift * prior.angular_acceleration, 1.0);
  if (exposure > 0.0) {
    const double common =
        std::hypot(kCommonXiError, kRelativeXiError * blur_px) * exposure / std::max(exposure, readout);
    diagonal.segment<3>(6).array() += variance(common, 0.0, job.median_depth);
    diagonal.segment<3>(9).array() += variance(common, 0.0, 1.0);
  }
  return covariance;
}

TrackedFrame Tracker::track(const Reference& reference, const FrameConstPtr& given, const TrackingGuess& guess) const {
  const auto begin = std::chrono::steady_clock::now();
  // An image that was made with another calibration than the reference goes by shows everything beside its place.
  const FrameConstPtr frame = withCamera(given, reference.correction);
  const int levels = std::min({config_.pyramid_levels, reference.pyramid->levels(), frame->pyramid.levels()});
  const Job job(reference, *frame, guess, levels, config_.max_points);
  AlignmentState state = guess.is_close ? starts(job).front() : bestStart(job, levels - 1);
  LevelResult result{};
  bool hopeless = false;
  const int first_level = std::max(std::min(levels - 2, guess.is_close ? kCloseLevel : levels), 0);
  for (int level = first_level; level >= 0 && !hopeless; --level) {
    state.bend = bendFor(job, state);
    // Coarser levels start far off: residuals there tell about the start, not about the images.
    const double huber_threshold = level == 0 ? kFollowResiduals : config_.huber_threshold;
    result = align(job, level, state, config_.max_iterations, huber_threshold);
    state = result.minimum.state;
    // Where so little agrees, finer levels only take their time: tracked frames of spin and shake have 0.4 or more.
    hopeless = level < first_level && result.minimum.equations.statistics.inlier_fraction < config_.min_inlier_fraction;
  }
  if (!hopeless) result = preferExpectedDirection(job, result);
  state = result.minimum.state;

  TrackedFrame tracked;
  tracked.frame = frame;
  tracked.reference = reference.id;
  const double exposure = job.exposureOf(state);
  tracked.trajectory = {state.T_reference_mid,
                        exposure > 0.0 ? Vector6(state.xi / exposure) : guess.trajectory.velocity,
                        guess.trajectory.exposure};
  if (exposure > 0.0) tracked.trajectory.acceleration = state.bend / (exposure * exposure);
  if (job.rolling && job.untold() > 0.0) {
    tracked.trajectory.exposure = exposure;
    tracked.exposure_by_rows = exposureByRows(job.exposure, state, result.minimum.equations);
  }
  tracked.brightness.a = reference.brightness.a + state.a;
  tracked.brightness.b = state.b + std::exp(state.a) * reference.brightness.b;
  const AlignmentStatistics& statistics = result.minimum.equations.statistics;
  tracked.points_used = statistics.patches;
  tracked.residual_rms = statistics.weighted_rms;
  tracked.inlier_fraction = statistics.inlier_fraction;
  tracked.measures = measureFrame(reference, tracked.trajectory);
  tracked.xi_prior_limited = tracked.measures.blur_length_px < kObservableBlur;
  tracked.covariance = covarianceOf(job, result, tracked.measures.blur_length_px);
  tracked.pixel_error =
      pixelError(reference, job.points.front(), frame->pyramid.level(0), state.T_reference_mid, tracked.residual_rms);
  // Points at infinity say nothing of the position.
  if (!reference.at_infinity) {
    tracked.expected_error =
        expectedPixelError(reference, state.T_reference_mid, tracked.covariance.topLeftCorner<6, 6>());
  }
  judge(reference, state.a, tracked);
  tracked.tracking_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return tracked;
}

}  // namespace mba_vo
