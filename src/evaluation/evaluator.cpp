#include "mba_vo/evaluation/evaluator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mba_vo/evaluation/association.h"
#include "mba_vo/evaluation/clock_hint.h"
#include "mba_vo/evaluation/exposure_motion.h"

namespace mba_vo {
namespace {

struct MatchedPoses {
  const std::vector<PoseRecord>& groundtruth;
  const std::vector<PoseRecord>& estimate;
  std::vector<Association> pairs;
};

Similarity align(const MatchedPoses& matched, AlignmentMode mode) {
  std::vector<Eigen::Vector3d> estimated;
  std::vector<Eigen::Vector3d> truth;
  for (const Association& pair : matched.pairs) {
    estimated.push_back(matched.estimate[pair.estimate].T_world_camera.translation());
    truth.push_back(matched.groundtruth[pair.groundtruth].T_world_camera.translation());
  }
  return alignPositions(estimated, truth, mode);
}

std::vector<PosePair> alignedPairs(const MatchedPoses& matched, const Similarity& alignment) {
  std::vector<PosePair> pairs;
  for (const Association& pair : matched.pairs) {
    const PoseRecord& truth = matched.groundtruth[pair.groundtruth];
    pairs.push_back({truth.time, truth.T_world_camera, alignment * matched.estimate[pair.estimate].T_world_camera});
  }
  return pairs;
}

double firstTime(const std::vector<PoseRecord>& poses) {
  const auto earlier = [](const PoseRecord& a, const PoseRecord& b) { return a.time < b.time; };
  return std::min_element(poses.begin(), poses.end(), earlier)->time;
}

/// Drops among the instants, of which `pairs` have a pose; `initialized`: when the first one was known, in any map [s].
FrameDrops countDrops(const std::vector<PoseRecord>& instants, const std::vector<Association>& pairs,
                      double initialized) {
  std::vector<bool> has_pose(instants.size(), false);
  for (const Association& pair : pairs) has_pose[pair.groundtruth] = true;
  FrameDrops drops;
  drops.frames = instants.size();
  for (std::size_t i = 0; i < instants.size(); ++i) {
    const bool after = instants[i].time >= initialized;
    drops.dropped += has_pose[i] ? 0 : 1;
    drops.frames_after_initialization += after ? 1 : 0;
    drops.dropped_after_initialization += after && !has_pose[i] ? 1 : 0;
  }
  return drops;
}

/// `evaluated`: the poses of one map in `estimate`.
FrameDrops dropsAmongFrames(const std::vector<LoggedFrame>& frames, const std::vector<PoseRecord>& evaluated,
                            const std::vector<PoseRecord>& estimate) {
  // The trajectory of a run carries the very stamps of its frame log, up to the decimals written.
  constexpr double kStampTolerance = 1e-5;  // [s]
  std::vector<PoseRecord> instants;
  for (const LoggedFrame& frame : frames) {
    if (frame.status == "REPEATED") continue;
    instants.emplace_back();
    instants.back().time = frame.time;
  }
  std::stable_sort(instants.begin(), instants.end(),
                   [](const PoseRecord& a, const PoseRecord& b) { return a.time < b.time; });
  return countDrops(instants, associateByTime(instants, evaluated, kStampTolerance),
                    firstTime(estimate) - kStampTolerance);
}

/// Start and end poses as poses of their own.
std::vector<PosePair> alignedEnds(const MatchedPoses& matched, const Similarity& alignment) {
  std::vector<PosePair> ends;
  for (const Association& pair : matched.pairs) {
    const PoseRecord& truth = matched.groundtruth[pair.groundtruth];
    const auto& estimated = matched.estimate[pair.estimate].exposure;
    if (!truth.exposure || !estimated) continue;
    ends.push_back({truth.time, truth.exposure->T_world_start, alignment * estimated->T_world_start});
    ends.push_back({truth.time, truth.exposure->T_world_end, alignment * estimated->T_world_end});
  }
  return ends;
}

std::optional<ExposureEvaluation> evaluateExposures(const MatchedPoses& matched, const Similarity& alignment,
                                                    double min_blur) {
  const std::vector<PosePair> ends = alignedEnds(matched, alignment);
  if (ends.empty()) return std::nullopt;
  std::vector<double> directions;
  std::vector<double> ratios;
  std::vector<double> length_errors;
  for (const Association& pair : matched.pairs) {
    const auto& truth = matched.groundtruth[pair.groundtruth].exposure;
    const auto& estimated = matched.estimate[pair.estimate].exposure;
    if (!truth || !estimated) continue;
    if (const auto error = compareExposureMotion(*truth, *estimated, alignment.scale, min_blur)) {
      directions.push_back(error->direction);
      ratios.push_back(error->length_ratio);
      length_errors.push_back(std::abs(error->length_ratio - 1.0));
    }
  }
  ExposureEvaluation evaluation;
  evaluation.ends = summarize(absoluteErrors(ends));
  evaluation.ends_rotation = summarize(rotationErrors(ends));
  constexpr double kRightAngle = 90.0;  // [deg]
  evaluation.reversed = static_cast<std::size_t>(
      std::count_if(directions.begin(), directions.end(), [](double angle) { return angle > kRightAngle; }));
  evaluation.direction = summarize(directions);
  evaluation.length_ratio = summarize(ratios);
  evaluation.length_error = summarize(length_errors);
  return evaluation;
}

}  // namespace

EvaluationReport evaluateTrajectory(const std::vector<PoseRecord>& groundtruth, const std::vector<PoseRecord>& estimate,
                                    const std::vector<LoggedFrame>& frame_log, const EvaluationOptions& options) {
  const std::vector<PoseRecord> evaluated = posesOfLargestMap(estimate);
  const MatchedPoses matched{groundtruth, evaluated,
                             associateByTime(groundtruth, evaluated, options.max_time_difference)};
  constexpr std::size_t kMinPairs = 3;
  const std::string hint = clockHint(groundtruth, evaluated);
  if (matched.pairs.size() < kMinPairs) {
    throw std::runtime_error(
        "only " + std::to_string(matched.pairs.size()) + " of " + std::to_string(evaluated.size()) +
        " estimated poses are within " + std::to_string(options.max_time_difference) +
        " s of a ground-truth pose, at least 3 are needed; " + (hint.empty() ? "do both use the same clock?" : hint));
  }
  EvaluationReport report;
  report.clock_hint = hint;
  report.map = evaluated.front().map;
  report.mode = options.alignment;
  report.relative_interval = options.relative_interval;
  report.alignment = align(matched, options.alignment);
  report.pairs = alignedPairs(matched, report.alignment);
  report.unmatched_estimates = evaluated.size() - matched.pairs.size();
  report.maps = countMaps(estimate);
  report.poses_in_other_maps = estimate.size() - evaluated.size();
  report.absolute = summarize(absoluteErrors(report.pairs));
  report.rotation = summarize(rotationErrors(report.pairs));
  constexpr double kIntervalTolerance = 0.1;  // of the interval
  const RelativeErrors relative =
      relativeErrors(report.pairs, options.relative_interval, kIntervalTolerance * options.relative_interval);
  report.relative_translation = summarize(relative.translation);
  report.relative_rotation = summarize(relative.rotation);
  report.drops = frame_log.empty()
                     ? countDrops(groundtruth, matched.pairs, firstTime(estimate) - options.max_time_difference)
                     : dropsAmongFrames(frame_log, evaluated, estimate);
  for (const LoggedFrame& frame : frame_log) {
    ++report.frames_by_status[frame.status];
  }
  report.exposure = evaluateExposures(matched, report.alignment, options.min_blur);
  return report;
}

}  // namespace mba_vo
