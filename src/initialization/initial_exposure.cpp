#include "mba_vo/initialization/initial_exposure.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

#include "mba_vo/initialization/reference_motion.h"

namespace mba_vo {
namespace {

// docs/decisions/2026-11-27-first-exposure.md
constexpr std::size_t kMostSamples = 5;  // each takes about as long as tracking a frame
constexpr double kLeastShown = 0.1;      // of a frame's blur
constexpr double kCommonSigma = 0.05;    // of the logarithm: blur and motion are never known better

struct Candidate {
  TrackedFrame tracked;
  Passage passage;

  double clarity() const { return passage.path_px * passage.shown(); }
};

double secondsBetween(const InitialMap::Pose& from, const InitialMap::Pose& to) {
  return 1e-9 * static_cast<double>(to.frame->mid_exposure_ns - from.frame->mid_exposure_ns);
}

/// With the reference's own.
std::vector<InitialMap::Pose> posesByTime(const InitialMap& initial) {
  std::vector<InitialMap::Pose> poses = initial.poses;
  const InitialMap::Pose own{initial.reference, SE3()};
  const auto earlier = [](const InitialMap::Pose& l, const InitialMap::Pose& r) { return secondsBetween(l, r) > 0.0; };
  poses.insert(std::lower_bound(poses.begin(), poses.end(), own, earlier), own);
  return poses;
}

Vector6 velocityBetween(const InitialMap::Pose& from, const InitialMap::Pose& to) {
  return (from.T_reference_frame.inverse() * to.T_reference_frame).log() / secondsBetween(from, to);
}

/// By the poses before and after, or, of the first and the last, as it goes on from the next two steps.
Vector6 velocityAt(const std::vector<InitialMap::Pose>& poses, std::size_t i) {
  const auto step = [&](std::size_t from) { return velocityBetween(poses[from], poses[from + 1]); };
  const std::size_t last = poses.size() - 1;
  if (i == 0) return 1.5 * step(0) - 0.5 * step(1);
  if (i == last) return 1.5 * step(last - 1) - 0.5 * step(last - 2);
  return 0.5 * (step(i - 1) + step(i));
}

/// The frames that tell, the clearest first.
std::vector<Candidate> candidates(const std::vector<InitialMap::Pose>& poses, const Reference& reference) {
  std::vector<Candidate> result;
  for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
    const double interval = 0.5 * secondsBetween(poses[i - 1], poses[i + 1]);
    const bool own = &poses[i].frame->pyramid == reference.pyramid.get();
    if (own) continue;
    Candidate candidate;
    candidate.tracked.frame = withExposure(poses[i].frame, std::nullopt, 0.0);
    candidate.tracked.trajectory.T_reference_mid = poses[i].T_reference_frame;
    candidate.passage = passageOf(reference, candidate.tracked, velocityAt(poses, i), interval);
    if (!candidate.passage.tells() || candidate.passage.shown() < kLeastShown) continue;
    result.push_back(std::move(candidate));
  }
  std::sort(result.begin(), result.end(),
            [](const Candidate& l, const Candidate& r) { return l.clarity() > r.clarity(); });
  if (result.size() > kMostSamples) result.resize(kMostSamples);
  return result;
}

/// Their median, weighted by what each is worth.
ExposureSample combined(std::vector<ExposureSample> samples) {
  std::sort(samples.begin(), samples.end(),
            [](const ExposureSample& l, const ExposureSample& r) { return l.exposure < r.exposure; });
  const auto information = [](const ExposureSample& sample) { return 1.0 / (sample.log_sigma * sample.log_sigma); };
  double sum = 0.0;
  for (const ExposureSample& sample : samples) sum += information(sample);
  double below = 0.0;
  const auto isMiddle = [&](const ExposureSample& sample) { return (below += information(sample)) >= 0.5 * sum; };
  const auto middle = std::find_if(samples.begin(), std::prev(samples.end()), isMiddle);
  return {middle->exposure, std::hypot(kCommonSigma, 1.0 / std::sqrt(sum))};
}

}  // namespace

std::optional<ExposureSample> initialExposure(const InitialMap& initial, const TrackerConfig& config) {
  const std::vector<InitialMap::Pose> poses = posesByTime(initial);
  if (poses.size() < 3) return std::nullopt;
  const auto isOwn = [&](const InitialMap::Pose& pose) { return pose.frame == initial.reference; };
  const auto own = std::find_if(poses.begin(), poses.end(), isOwn) - poses.begin();
  const Reference reference = initialReference(initial, {velocityAt(poses, static_cast<std::size_t>(own))});
  std::vector<ExposureSample> samples;
  ExposureSample expected{config.unknown_exposure, kAssumedExposureSigma};
  for (const Candidate& candidate : candidates(poses, reference)) {
    const auto sample =
        sampleExposure(reference, candidate.tracked, candidate.passage, 0.0, expected, std::nullopt, config);
    if (!sample) continue;
    samples.push_back(*sample);
    expected = combined(samples);
  }
  if (samples.empty()) return std::nullopt;
  return combined(samples);
}

}  // namespace mba_vo
