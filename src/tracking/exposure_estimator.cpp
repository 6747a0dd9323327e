#include "mba_vo/tracking/exposure_estimator.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace mba_vo {
namespace {

constexpr std::size_t kNeighbours = 5;  // the frame itself is the middle one
constexpr double kSmooth = 0.3;         // of the motion, most that the frames farther away may change of it
constexpr std::size_t kRememberedSamples = 60;
constexpr std::size_t kLeastSamples = 8;
constexpr int kRareProbes = 3;            // every so many frames, once there are enough samples
constexpr int kSeldomProbes = 10;         // the same, once they agree: a probe costs as much as tracking a frame
constexpr int kVaryingProbes = 2;         // the same, of exposures that change
constexpr double kAgreement = 0.2;        // of log ratio, between the last sample and a well-known ratio
constexpr double kWellKnownSigma = 0.05;  // of log ratio
// Blur of the reference, as a share of the frame's along it, that is too much: 0.6 leaves too few samples, 1 and more
// too many wrong ones (docs/decisions/2026-11-21-unknown-exposure.md).
constexpr double kLikeReference = 0.8;
// The same where rows tell the velocity: from frame to keyframe to frame an error grows from there on. Values of
// these four: docs/decisions/2026-11-28-exposures-by-rows.md.
constexpr double kMostAlike = 1.2;
constexpr double kReferenceSigma = 0.1;    // of the logarithm of the reference's exposure
constexpr double kRowsSigma = 0.1;         // [px] of blur, that path and patches have wrong
constexpr double kLargestRowsSigma = 0.7;  // of log exposure; a sample that tells less is none
constexpr int kLeastUnknownSamples = 1;    // from which on they are better than the assumed exposure
constexpr double kWrong = 0.2;             // |log ratio| from which on exposures that came are not believed
constexpr double kRightAgain = 0.1;        // the same, until which they are not
constexpr double kSignificance = 4.0;      // standard deviations
constexpr double kCommon = 2.0;            // the same of one sample, for what all have wrong alike does not average out
constexpr double kMedianSigma = 1.2533 * 1.4826;  // of a median, over median deviation / sqrt(samples)

double seconds(const TrackedFrame& from, const TrackedFrame& to) {
  return 1e-9 * static_cast<double>(to.frame->mid_exposure_ns - from.frame->mid_exposure_ns);
}

/// Derivative at time 0 of the polynomial through the values, one of which is zero and at time 0.
Vector6 derivativeAtZero(const std::vector<double>& times, const std::vector<Vector6>& values) {
  Vector6 derivative = Vector6::Zero();
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] == 0.0) continue;
    double factor = 1.0 / times[i];
    for (std::size_t j = 0; j < times.size(); ++j) {
      if (j != i && times[j] != 0.0) factor *= times[j] / (times[j] - times[i]);
    }
    derivative += factor * values[i];
  }
  return derivative;
}

}  // namespace

ExposureEstimator::ExposureEstimator(const TrackerConfig& config)
    : config_(config), unknown_(0.0, kAssumedExposureSigma) {}

ExposureEstimate ExposureEstimator::estimate(bool given, std::int64_t mid_exposure_ns) const {
  if (given) return ratio_.estimate;
  if (unknown_.samples() < kLeastUnknownSamples) return {};
  const ExposureFilter::Estimate now = unknown_.at(1e-9 * static_cast<double>(mid_exposure_ns));
  return {std::exp(now.log_exposure), now.sigma, unknown_.samples() >= kLeastUnknownSamples, unknown_.varies()};
}

std::optional<double> ExposureEstimator::exposureFor(const std::optional<double>& given,
                                                     std::int64_t mid_exposure_ns) const {
  const ExposureEstimate e = estimate(given.has_value(), mid_exposure_ns);
  if (!e.used || (given && *given <= 0.0)) return given;
  return e.ratio * given.value_or(config_.unknown_exposure);
}

void ExposureEstimator::changeReference(const SE3& T_new_old) {
  for (Seen& seen : seen_) seen.T_reference_mid = T_new_old * seen.T_reference_mid;
}

void ExposureEstimator::reset() {
  seen_.clear();
  ratio_ = {};
  unknown_ = ExposureFilter(0.0, kAssumedExposureSigma);
  history_.reset();
  newest_probed_ns_ = 0;
  left_out_ = 0;
}

void ExposureEstimator::add(const ReferenceConstPtr& reference, const std::shared_ptr<const TrackedFrame>& tracked,
                            const std::optional<double>& given) {
  if (!config_.estimate_exposure) return;
  if (!given && tracked->frame->pyramid.level(0).camera.row_time != 0.0) return addByRows(*reference, *tracked);
  const bool good = tracked->status == TrackingStatus::kTracking && given.value_or(1.0) > 0.0;
  if (!good || (!seen_.empty() && seconds(*seen_.back().tracked, *tracked) <= 0.0)) seen_.clear();
  if (!good) return;
  seen_.push_back(
      {tracked, tracked->trajectory.T_reference_mid, given.value_or(config_.unknown_exposure), given.has_value()});
  if (seen_.size() > kNeighbours) seen_.pop_front();
  if (seen_.size() < kNeighbours) return;
  const Seen& middle = seen_[kNeighbours / 2];
  if (middle.tracked->frame->mid_exposure_ns <= newest_probed_ns_) return;
  if (++left_out_ < framesBetweenProbes(middle.known)) return;
  const std::optional<ExposureSample> sample = probeMiddle(*reference);
  if (!sample) return;
  newest_probed_ns_ = middle.tracked->frame->mid_exposure_ns;
  const double log_ratio = std::log(sample->exposure / middle.given);
  if (!middle.known) {
    unknown_.add(middle.tracked->frame->midExposureSeconds(), log_ratio, sample->log_sigma);
    updateHistory();
    return;
  }
  ratio_.samples.push_back({log_ratio, 1.0 / (sample->log_sigma * sample->log_sigma)});
  if (ratio_.samples.size() > kRememberedSamples) ratio_.samples.pop_front();
  update(ratio_);
}

/// What the reference's exposure has wrong enters by the square of how much of the blur it goes along with.
void ExposureEstimator::addByRows(const Reference& reference, const TrackedFrame& tracked) {
  if (!tracked.tracked() || !tracked.exposure_by_rows) return;
  const ExposureTrajectory& trajectory = tracked.trajectory;
  const Passage passage = passageOf(reference, tracked, trajectory.velocity, trajectory.exposure);
  if (std::abs(passage.alike) > kMostAlike) return;
  ExposureSample sample = *tracked.exposure_by_rows;
  sample.log_sigma =
      std::hypot(sample.log_sigma, kRowsSigma / passage.path_px, kReferenceSigma * passage.alike * passage.alike);
  if (!(sample.log_sigma < kLargestRowsSigma)) return;
  // None is longer than the time since the image before.
  const double time = tracked.frame->midExposureSeconds();
  if (history_) sample.exposure = std::min(sample.exposure, time - history_->newestTime());
  if (sample.exposure > 0.0) learn(tracked.frame->mid_exposure_ns, asShortAsMayBe(sample));
}

void ExposureEstimator::learn(std::int64_t mid_exposure_ns, const ExposureSample& sample) {
  const double time = 1e-9 * static_cast<double>(mid_exposure_ns);
  if (history_ && time <= history_->newestTime()) return;
  unknown_.add(time, std::log(sample.exposure / config_.unknown_exposure), sample.log_sigma);
  updateHistory();
}

int ExposureEstimator::framesBetweenProbes(bool known) const {
  if (!known) return unknown_.samples() < static_cast<int>(kLeastSamples) ? 1 : kVaryingProbes;
  if (ratio_.samples.size() < kLeastSamples) return 1;
  const double difference = ratio_.samples.back().log_ratio - std::log(ratio_.estimate.ratio);
  const bool settled = ratio_.estimate.log_sigma < kWellKnownSigma && std::abs(difference) < kAgreement;
  return settled ? kSeldomProbes : kRareProbes;
}

std::optional<ExposureSample> ExposureEstimator::probeMiddle(const Reference& reference) {
  std::vector<double> times;
  std::vector<Vector6> motions;
  const Seen& middle = seen_[kNeighbours / 2];
  for (const Seen& seen : seen_) {
    times.push_back(seconds(*middle.tracked, *seen.tracked));
    motions.push_back((middle.T_reference_mid.inverse() * seen.T_reference_mid).log());
  }
  const double interval = 0.25 * (times.back() - times.front());
  const Vector6 velocity = derivativeAtZero(times, motions);
  const Vector6 rough = derivativeAtZero({times[1], 0.0, times[3]}, {motions[1], motions[2], motions[3]});
  TrackedFrame tracked = *middle.tracked;
  tracked.trajectory.T_reference_mid = middle.T_reference_mid;
  const Passage passage = passageOf(reference, tracked, velocity, interval);
  const double doubt_px = passageOf(reference, tracked, velocity - rough, interval).path_px;
  if (!passage.tells() || doubt_px > kSmooth * passage.path_px) return std::nullopt;
  if (std::abs(passage.alike) > kLikeReference) return std::nullopt;
  left_out_ = 0;
  const ExposureEstimate expected = estimate(middle.known, middle.tracked->frame->mid_exposure_ns);
  return sampleExposure(reference, tracked, passage, doubt_px, {expected.ratio * middle.given, expected.log_sigma},
                        middle.known ? std::optional(middle.given) : std::nullopt, config_);
}

void ExposureEstimator::updateHistory() {
  std::vector<ExposureHistory::Entry> entries = unknown_.smoothed();
  for (ExposureHistory::Entry& entry : entries) entry.log_exposure += std::log(config_.unknown_exposure);
  history_ = std::make_shared<const ExposureHistory>(std::move(entries));
}

void ExposureEstimator::update(Ratio& ratio) {
  std::vector<Sample> samples(ratio.samples.begin(), ratio.samples.end());
  const double middle = weightedMedian(samples);
  double sum = 0.0;
  double squares = 0.0;
  for (Sample& s : samples) {
    sum += s.weight;
    squares += s.weight * s.weight;
    s.log_ratio = std::abs(s.log_ratio - middle);
  }
  ExposureEstimate& estimate = ratio.estimate;
  estimate.ratio = std::exp(middle);
  estimate.log_sigma = kMedianSigma * weightedMedian(samples) * std::sqrt(squares) / sum;
  if (samples.size() < kLeastSamples) return;
  const double least = estimate.used ? kRightAgain : kWrong;
  const double sigma_of_one = std::sqrt(static_cast<double>(samples.size()) / sum);
  estimate.used = std::abs(middle) > std::max({least, kSignificance * estimate.log_sigma, kCommon * sigma_of_one});
}

double ExposureEstimator::weightedMedian(std::vector<Sample> samples) {
  std::sort(samples.begin(), samples.end(), [](const Sample& l, const Sample& r) { return l.log_ratio < r.log_ratio; });
  const double sum = std::accumulate(samples.begin(), samples.end(), 0.0,
                                     [](double part, const Sample& s) { return part + s.weight; });
  double below = 0.0;
  for (const Sample& s : samples) {
    below += s.weight;
    if (below >= 0.5 * sum) return s.log_ratio;
  }
  return samples.back().log_ratio;
}

}  // namespace mba_vo
