#include "mba_vo/tracking/tracker.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "mba_vo/solver/levenberg_marquardt.h"
#include "mba_vo/tracking/frame_measures.h"
#include "mba_vo/tracking/point_subset.h"

namespace mba_vo {
namespace {

constexpr int kStartIterations = 6;          // spent on each alternative start on the coarsest level
constexpr std::size_t kFinerStarts = 3;      // compared again on the next level
constexpr double kSameBasin = 2.0;           // [px] results nearer than this are one
constexpr double kLeastBlurToSeed = 0.5;     // [px] shorter motion gives no direction to descend along
constexpr double kObservableBlur = 3.0;      // [px] below it the covariance of xi means nothing
constexpr double kImplausibleBlur = 0.25;    // of the image's width
constexpr double kImplausibleLogGain = 1.6;  // contrast five times higher or lower than the reference's
constexpr double kCorrelatedPixels = 20.0;   // pixels per independent observation: model errors are shared in a patch

/// Coarse levels see less detail per patch, and 9x9 pixels there span too much depth.
int patchSide(int level) { return level <= 1 ? 9 : 7; }

/// A direction to descend along where none is known: at xi = 0 the derivative of the blur vanishes.
Vector6 seededXi(const Vector6& xi, double fx) {
  if (fx * xi.tail<3>().norm() >= kLeastBlurToSeed) return xi;
  Vector6 seed = xi;
  seed(4) += kLeastBlurToSeed / fx;
  return seed;
}

std::string format(const char* text, double value) {
  std::array<char, 128> buffer{};
  std::snprintf(buffer.data(), buffer.size(), text, value);
  return buffer.data();
}

double medianInverseDepth(const Reference& reference) {
  std::vector<float> values;
  values.reserve(reference.points.size());
  for (const ReferencePoint& p : reference.points) values.push_back(p.inverse_depth);
  if (values.empty()) return 1.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

struct Tracker::LevelResult {
  LevenbergMarquardtSummary<AlignmentState, AlignmentProblem::kStates> minimum;
  AlignmentStatistics statistics;
  int patches = 0;
  double meanCost() const { return patches > 0 ? minimum.equations.cost / patches : 1e30; }
};

std::optional<AlignmentPrior> Tracker::priorFor(const Reference& reference, const TrackingGuess& guess,
                                                const AlignmentState& state) const {
  if (!guess.motion || guess.motion->dt == 0.0) return std::nullopt;
  const double depth = 1.0 / medianInverseDepth(reference);
  const double exposure = guess.trajectory.exposure;
  AlignmentPrior prior;
  prior.T_reference_mid = guess.motion->predict(exposure).T_reference_mid;
  prior.pose_information = guess.motion->poseInformation(config_.motion_prior, depth);
  if (exposure > 0.0) {
    prior.xi = guess.motion->expectedXi(state.T_reference_mid, exposure);
    prior.xi_information = guess.motion->xiInformation(config_.motion_prior, depth, exposure);
  }
  return prior;
}

Tracker::LevelResult Tracker::align(const Reference& reference, const Frame& frame, const TrackingGuess& guess,
                                    int level, const AlignmentState& initial, int max_iterations) const {
  const int side = patchSide(level);
  const PatchPattern pattern = PatchPattern::square(side);
  const std::vector<int> points = selectEvenSubset(reference, level, side, config_.max_points);
  AlignmentOptions options;
  options.huber_threshold = config_.huber_threshold;
  options.sample_spacing_px = config_.sample_spacing_px;
  options.max_samples = config_.max_samples;
  options.estimate_xi = guess.trajectory.exposure > 0.0;
  AlignmentProblem problem(reference, points, frame, level, pattern, options, priorFor(reference, guess, initial),
                           initial);
  LevenbergMarquardtOptions lm;
  lm.max_iterations = max_iterations;
  LevelResult result{minimize(problem, initial, lm), {}, 0};
  problem.linearize(result.minimum.state);
  result.statistics = problem.statistics();
  result.patches = problem.patches();
  return result;
}

std::vector<AlignmentState> Tracker::starts(const Reference& reference, const TrackingGuess& guess) const {
  const double fx = reference.pyramid->level(0).camera.fx;
  const double exposure = guess.trajectory.exposure;
  AlignmentState first;
  first.T_reference_mid = guess.trajectory.T_reference_mid;
  first.xi = exposure > 0.0 ? seededXi(guess.trajectory.xi(), fx) : Vector6::Zero();
  first.a = guess.brightness.a - reference.brightness.a;
  first.b = guess.brightness.b - std::exp(first.a) * reference.brightness.b;
  std::vector<AlignmentState> starts = {first};
  if (!guess.motion || guess.motion->dt == 0.0) return starts;
  for (const SE3& pose : guess.motion->alternatives()) {
    AlignmentState start = first;
    start.T_reference_mid = pose;
    if (exposure > 0.0) start.xi = seededXi(guess.motion->expectedXi(pose, exposure), fx);
    starts.push_back(start);
  }
  return starts;
}

AlignmentState Tracker::bestStart(const Reference& reference, const Frame& frame, const TrackingGuess& guess,
                                  int level) const {
  std::vector<LevelResult> coarse;
  for (const AlignmentState& start : starts(reference, guess)) {
    coarse.push_back(align(reference, frame, guess, level, start, kStartIterations));
  }
  // The coarsest level tells little: the best few are compared again one level finer, if they differ there.
  std::sort(coarse.begin(), coarse.end(), [](const auto& l, const auto& r) { return l.meanCost() < r.meanCost(); });
  const double fx = reference.pyramid->level(0).camera.fx;
  std::vector<LevelResult> finer;
  for (const LevelResult& candidate : coarse) {
    if (finer.size() >= kFinerStarts || candidate.patches < coarse.front().patches / 2) continue;
    LevelResult result =
        align(reference, frame, guess, std::max(level - 1, 0), candidate.minimum.state, kStartIterations);
    const auto same = [&](const LevelResult& other) {
      const SE3 between = other.minimum.state.T_reference_mid.inverse() * result.minimum.state.T_reference_mid;
      return fx * between.log().tail<3>().norm() < kSameBasin;
    };
    if (std::none_of(finer.begin(), finer.end(), same)) finer.push_back(result);
  }
  const auto better = [](const auto& l, const auto& r) { return l.meanCost() < r.meanCost(); };
  return std::min_element(finer.begin(), finer.end(), better)->minimum.state;
}

Tracker::LevelResult Tracker::preferExpectedDirection(const Reference& reference, const Frame& frame,
                                                      const TrackingGuess& guess, LevelResult result) const {
  // The blurred image hardly tells xi from -xi; continuity with the previous frame does.
  const auto prior = priorFor(reference, guess, result.minimum.state);
  if (!prior || guess.trajectory.exposure <= 0.0) return result;
  const Vector6& xi = result.minimum.state.xi;
  if (xi.dot(prior->xi_information.cwiseProduct(prior->xi)) >= 0.0) return result;
  AlignmentState reversed = result.minimum.state;
  reversed.xi = -xi;
  const LevelResult other = align(reference, frame, guess, 0, reversed, config_.max_iterations);
  const bool same_data = other.patches >= result.patches - result.patches / 20;
  return same_data && other.meanCost() < result.meanCost() ? other : result;
}

void Tracker::judge(double log_gain, TrackedFrame& tracked) const {
  tracked.status = TrackingStatus::kTracking;
  if (tracked.points_used < config_.min_patches) {
    tracked.status = TrackingStatus::kLost;
    tracked.reason = format("only %.0f patches of the reference are visible", tracked.points_used);
  } else if (tracked.inlier_fraction < config_.min_inlier_fraction) {
    tracked.status = TrackingStatus::kLost;
    tracked.reason = format("only %.2f of the pixels agree with the reference", tracked.inlier_fraction);
  } else if (std::abs(log_gain) > kImplausibleLogGain) {
    // An image without texture agrees with any reference whose contrast is taken away.
    tracked.status = TrackingStatus::kLost;
    tracked.reason = format("an implausible change of contrast by %.3g was found", std::exp(log_gain));
  } else if (tracked.measures.blur_length_px > kImplausibleBlur * tracked.frame->pyramid.level(0).camera.width) {
    tracked.status = TrackingStatus::kLost;
    tracked.reason = format("an implausible blur of %.0f px was found", tracked.measures.blur_length_px);
  } else if (tracked.inlier_fraction < config_.degraded_inlier_fraction) {
    tracked.status = TrackingStatus::kDegraded;
    tracked.reason = format("only %.2f of the pixels agree with the reference", tracked.inlier_fraction);
  }
}

TrackedFrame Tracker::track(const Reference& reference, const FrameConstPtr& frame, const TrackingGuess& guess) const {
  const auto begin = std::chrono::steady_clock::now();
  const int levels = std::min({config_.pyramid_levels, reference.pyramid->levels(), frame->pyramid.levels()});
  AlignmentState state = bestStart(reference, *frame, guess, levels - 1);
  LevelResult result{};
  for (int level = std::max(levels - 2, 0); level >= 0; --level) {
    result = align(reference, *frame, guess, level, state, config_.max_iterations);
    state = result.minimum.state;
  }
  result = preferExpectedDirection(reference, *frame, guess, result);
  state = result.minimum.state;

  TrackedFrame tracked;
  tracked.frame = frame;
  tracked.reference = reference.id;
  const double exposure = guess.trajectory.exposure;
  tracked.trajectory = {state.T_reference_mid,
                        exposure > 0.0 ? Vector6(state.xi / exposure) : guess.trajectory.velocity, exposure};
  tracked.brightness.a = reference.brightness.a + state.a;
  tracked.brightness.b = state.b + std::exp(state.a) * reference.brightness.b;
  tracked.points_used = result.statistics.patches;
  tracked.residual_rms = result.statistics.weighted_rms;
  tracked.inlier_fraction = result.statistics.inlier_fraction;
  tracked.measures = measureFrame(reference, tracked.trajectory);
  tracked.xi_prior_limited = tracked.measures.blur_length_px < kObservableBlur;
  const double variance = kCorrelatedPixels * tracked.residual_rms * tracked.residual_rms;
  const Eigen::Matrix<double, 14, 14> covariance = variance * result.minimum.equations.hessian.inverse();
  tracked.covariance = covariance.topLeftCorner<12, 12>();
  judge(state.a, tracked);
  tracked.tracking_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return tracked;
}

}  // namespace mba_vo
