#include "mba_vo/tracking/exposure_probe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "mba_vo/solver/levenberg_marquardt.h"
#include "mba_vo/tracking/frame_measures.h"
#include "mba_vo/tracking/point_subset.h"

namespace mba_vo {
namespace {

constexpr int kPatchSide = 9;
constexpr int kPatches = 120;
constexpr int kIterations = 3;
constexpr double kStep = 1.25;           // between exposures that are tried
constexpr double kFineStep = 0.12;       // relative
constexpr int kMostSteps = 7;            // away from the first one
constexpr double kLittleKnown = 0.15;    // log sigma of the expected exposure from which on all are tried
constexpr double kCoarseStep = 2.0;      // between them: the valley of the best one is as wide
constexpr double kShortest = 1e-3;       // [s] of them
constexpr double kFixed = 1e12;          // information that leaves no freedom
constexpr double kReferenceShare = 0.5;  // of the variance of the residuals
constexpr double kLargestSigma = 0.7;    // of log exposure; a sample that tells less is none
constexpr double kLongest = 1.5;         // exposure that is tried, in intervals; their noise is not to be cut off
constexpr double kBlurSigma = 0.3;       // [px] what path and patches have wrong
// Images taken for blurred too widely by 7 % spoil a map, too narrowly they do not. So what nobody told is taken for as
// short as it may well be: a standard deviation less, at most this much of its logarithm, twice of what estimates are
// too long (docs/decisions/2026-11-27-first-exposure.md).
constexpr double kMostCaution = 0.1;
constexpr double kLongestInterval = 0.1;  // [s] between frames, over which a velocity is known
constexpr double kLeastMotion = 3.0;      // [px] from frame to frame

double square(double x) { return x * x; }

/// Velocity that makes the blur left in a reference, if it was exposed as long as the frame.
Vector6 blurVelocity(const Reference& reference, const TrackedFrame& tracked) {
  // An image whose exposure was not known was taken for sharp.
  const bool known = tracked.frame->exposure && !reference.image_xi.isZero(0.0);
  return known ? Vector6(reference.image_xi / *tracked.frame->exposure) : reference.motion.velocity;
}

/// The best alignment of a frame for an exposure.
struct Trial {
  double exposure;         // [s]
  double cost;             // per patch
  double gradient_energy;  // of the prediction, mean square [grey levels^2/px^2]
};

/// Cost of the best alignment of a frame for a given exposure.
class Probe {
 public:
  Probe(const Reference& reference, const TrackedFrame& tracked, const Vector6& velocity, const TrackerConfig& config)
      : reference_(reference),
        fx_(reference.pyramid->level(0).camera.fx),
        tracked_(tracked),
        frame_(withCamera(tracked.frame, reference.correction)),
        velocity_(velocity),
        points_(selectEvenSubset(reference, 0, kPatchSide, kPatches)),
        pattern_(PatchPattern::square(kPatchSide)) {
    options_.huber_threshold = config.huber_threshold;
    options_.sample_spacing_px = config.sample_spacing_px;
    options_.max_samples = config.max_samples;
    state_.T_reference_mid = tracked.trajectory.T_reference_mid;
    state_.a = tracked.brightness.a - reference.brightness.a;
    state_.b = tracked.brightness.b - std::exp(state_.a) * reference.brightness.b;
  }

  /// Pose and brightness are free, the motion within the exposure is not.
  Trial tryOut(double exposure) {
    Reference reference = reference_;
    reference.image_xi = exposure * blurVelocity(reference_, tracked_);
    AlignmentOptions options = options_;
    options.exposure = exposure;
    AlignmentPrior prior;
    prior.T_reference_mid = state_.T_reference_mid;
    prior.xi = exposure * velocity_;
    prior.xi_information.setConstant(kFixed);
    AlignmentState initial = state_;
    initial.xi = prior.xi;
    AlignmentProblem problem(reference, points_, *frame_, 0, pattern_, options, prior, initial);
    LevenbergMarquardtOptions lm;
    lm.max_iterations = kIterations;
    const auto minimum = minimize(problem, initial, lm);
    patches_ = std::max(1, problem.patches());
    const double pixels = std::max(1, minimum.equations.statistics.pixels);
    const double energy = (minimum.equations.hessian(3, 3) + minimum.equations.hessian(4, 4)) / (fx_ * fx_ * pixels);
    return {exposure, minimum.equations.cost / patches_, energy};
  }
  double information(double curvature) const {
    return patches_ * curvature / (options_.residual_sigma * options_.residual_sigma);
  }

 private:
  const Reference& reference_;
  double fx_;
  const TrackedFrame& tracked_;
  FrameConstPtr frame_;
  Vector6 velocity_;
  std::vector<int> points_;
  PatchPattern pattern_;
  AlignmentOptions options_;
  AlignmentState state_;
  int patches_ = 1;
};

using Trials = std::array<Trial, 3>;

/// Three trials with the best one in the middle, if there is such.
std::optional<Trials> bracket(Probe& probe, double first, double longest) {
  Trials trials = {probe.tryOut(first / kStep), probe.tryOut(first), probe.tryOut(first * kStep)};
  for (int step = 1; step < kMostSteps; ++step) {
    if (trials[0].cost < trials[1].cost) {
      trials = {probe.tryOut(trials[0].exposure / kStep), trials[0], trials[1]};
    } else if (trials[2].cost < trials[1].cost) {
      if (trials[2].exposure > longest) return std::nullopt;
      trials = {trials[1], trials[2], probe.tryOut(trials[2].exposure * kStep)};
    } else {
      return trials;
    }
  }
  return std::nullopt;
}

/// The best one of exposures all over the range.
double roughlyBest(Probe& probe, double expected, double longest) {
  Trial best = probe.tryOut(expected);
  for (double exposure = longest; exposure > kShortest; exposure /= kCoarseStep) {
    const Trial trial = probe.tryOut(exposure);
    if (trial.cost < best.cost) best = trial;
  }
  return best.exposure;
}

/// What the reference has wrong, its depths above all, shows the less the more blurred the prediction is: without
/// compensation too long an exposure would look best. As in the regression of a line with errors in both variables, the
/// cost is divided by the variance that is to be expected; part of it comes from the reference.
void compensateForErrors(Trials& trials) {
  const double expected = trials[1].gradient_energy;
  for (Trial& trial : trials) {
    trial.cost /= 1.0 - kReferenceShare + kReferenceShare * trial.gradient_energy / expected;
  }
}

/// Of the parabola through three trials.
struct Vertex {
  double exposure, curvature;
};

Vertex vertexOf(const Trials& trials) {
  const auto& [left, middle, right] = trials;
  const double l = left.exposure - middle.exposure;
  const double r = right.exposure - middle.exposure;
  const double left_slope = (left.cost - middle.cost) / l;
  const double right_slope = (right.cost - middle.cost) / r;
  const double half_curvature = (right_slope - left_slope) / (r - l);
  return {middle.exposure + 0.5 * (l - left_slope / half_curvature), 2.0 * half_curvature};
}

}  // namespace

std::optional<ExposureSample> probeExposure(const Reference& reference, const TrackedFrame& tracked,
                                            const Vector6& velocity, const ExposureSample& expected, double longest,
                                            const TrackerConfig& config) {
  Probe probe(reference, tracked, velocity, config);
  const bool little_known = !(expected.log_sigma < kLittleKnown);
  const double first = little_known ? roughlyBest(probe, expected.exposure, longest) : expected.exposure;
  const auto trials = bracket(probe, first, longest);
  if (!trials) return std::nullopt;
  // The cost grows less than quadratically: once more, as far to either side.
  const double centre = vertexOf(*trials).exposure;
  Trials fine = {probe.tryOut((1.0 - kFineStep) * centre), probe.tryOut(centre),
                 probe.tryOut((1.0 + kFineStep) * centre)};
  compensateForErrors(fine);
  const Vertex vertex = vertexOf(fine);
  const bool near = std::abs(vertex.exposure - centre) < 2.0 * kFineStep * centre;
  if (!(vertex.curvature > 0.0) || !near) return std::nullopt;
  ExposureSample sample;
  sample.exposure = vertex.exposure;
  const double information = probe.information(vertex.curvature) * sample.exposure * sample.exposure;
  sample.log_sigma = 1.0 / std::sqrt(information);
  if (!(sample.log_sigma < kLargestSigma)) return std::nullopt;
  return sample;
}

bool Passage::tells() const { return interval <= kLongestInterval && path_px >= kLeastMotion; }

double Passage::shown() const { return std::abs(1.0 - square(alike)); }

Passage passageOf(const Reference& reference, const TrackedFrame& tracked, const Vector6& velocity, double interval) {
  const auto pathOf = [&](const Vector6& v) {
    return measureFrame(reference, {tracked.trajectory.T_reference_mid, v, interval}).blur_length_px;
  };
  const double path = pathOf(velocity);
  const Vector6 of_reference = blurVelocity(reference, tracked);
  const double alike =
      (square(pathOf(velocity + of_reference)) - square(pathOf(velocity - of_reference))) / (4.0 * square(path));
  return {velocity, interval, path, alike};
}

ExposureSample asShortAsMayBe(ExposureSample sample) {
  sample.exposure *= std::exp(-std::min(sample.log_sigma, kMostCaution));
  return sample;
}

std::optional<ExposureSample> sampleExposure(const Reference& reference, const TrackedFrame& tracked,
                                             const Passage& passage, double doubt_px, const ExposureSample& expected,
                                             const std::optional<double>& told, const TrackerConfig& config) {
  auto sample = probeExposure(reference, tracked, passage.velocity, expected, kLongest * passage.interval, config);
  if (!sample) return std::nullopt;
  // What is wrong in a short blur makes it seem long: an exposure that came is doubted by the blur it would make.
  const double least = std::min(told.value_or(sample->exposure), sample->exposure);
  const double blur = passage.path_px * least / passage.interval;  // [px]
  const double shown = passage.shown();
  sample->log_sigma = std::hypot(sample->log_sigma, doubt_px / passage.path_px / shown, kBlurSigma / blur / shown);
  sample->exposure = std::min(sample->exposure, passage.interval);  // none is longer than until the next image
  return told ? sample : asShortAsMayBe(*sample);
}

}  // namespace mba_vo
