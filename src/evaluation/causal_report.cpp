#include "mba_vo/evaluation/causal_report.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mba_vo/evaluation/true_motion.h"

namespace mba_vo {
namespace {

TrajectoryFigures evaluate(const std::vector<PoseRecord>& groundtruth, const std::vector<PoseRecord>& poses,
                           const std::vector<LoggedFrame>& frames, const EvaluationOptions& options) {
  if (poses.empty()) {
    return {std::nullopt, "no pose"};
  }
  try {
    return {evaluateTrajectory(groundtruth, poses, frames, options), ""};
  } catch (const std::runtime_error& error) {
    return {std::nullopt, error.what()};
  }
}

/// Maps begin with a median depth of 1, so their scale is the median depth in metres, unless it is known to be 1.
SceneDepth sceneDepth(const std::vector<PoseRecord>& groundtruth, const RunFolder& run, const RunOptions& options) {
  if (options.depth) {
    return {*options.depth, SceneDepth::Source::kGiven};
  }
  EvaluationOptions with_scale = options.evaluation;
  with_scale.alignment = AlignmentMode::kSim3;
  const auto depthOf = [&](const std::vector<PoseRecord>& poses) {
    const TrajectoryFigures figures = evaluate(groundtruth, poses, {}, with_scale);
    return figures.report ? figures.report->alignment.scale : 0.0;
  };
  if (!run.metric) {
    if (const double online = depthOf(run.online_trajectory); online > 0.0) {
      return {online, SceneDepth::Source::kOnline};
    }
    if (const double smoothed = depthOf(run.smoothed); smoothed > 0.0) {
      return {smoothed, SceneDepth::Source::kSmoothed};
    }
  }
  constexpr double kUsualDepth = 2.0;  // of a room [m]
  return {kUsualDepth, SceneDepth::Source::kAssumed};
}

std::size_t countLoggedWithoutPose(const RunFolder& run) {
  constexpr double kStampTolerance = 1e-5;  // decimals written to files [s]
  const std::vector<PoseRecord>& poses = run.online_odometry;
  const auto lacks = [&](const OnlineFrame& frame) {
    const auto pose = std::lower_bound(poses.begin(), poses.end(), frame.time - kStampTolerance,
                                       [](const PoseRecord& p, double time) { return p.time < time; });
    return frame.hasPose() && (pose == poses.end() || pose->time > frame.time + kStampTolerance);
  };
  return static_cast<std::size_t>(std::count_if(run.online_frames.begin(), run.online_frames.end(), lacks));
}

}  // namespace

RunReport evaluateRun(const std::vector<PoseRecord>& groundtruth, const RunFolder& run, const RunOptions& options) {
  RunReport report;
  report.mode = options.evaluation.alignment;
  report.trajectory = evaluate(groundtruth, run.online_trajectory, run.frames, options.evaluation);
  report.odometry = evaluate(groundtruth, run.online_odometry, run.frames, options.evaluation);
  report.smoothed = evaluate(groundtruth, run.smoothed, run.frames, options.evaluation);
  constexpr std::size_t kEnough = 3;  // poses to compare
  const bool comparable = report.trajectory.report || report.odometry.report || report.smoothed.report;
  if (!comparable && std::max(run.online_trajectory.size(), run.smoothed.size()) >= kEnough) {
    const bool online = run.online_trajectory.size() >= kEnough;
    throw std::runtime_error((online ? report.trajectory : report.smoothed).unavailable);
  }
  report.depth = sceneDepth(groundtruth, run, options);
  report.metric = run.metric;
  constexpr double kParallax = 0.02;  // of the depth; enough for a map
  report.parallax_time = timeOfDistance(groundtruth, run.online_frames.front().time, kParallax * report.depth.metres);
  report.availability = measureAvailability(run.online_frames, report.parallax_time);
  const bool fit_scale = options.evaluation.alignment == AlignmentMode::kSim3;
  report.consistency =
      measureConsistency(groundtruth, run.online_odometry, run.online_frames, {options.nees_times, fit_scale});
  report.logged_without_pose = countLoggedWithoutPose(run);
  report.restarts = run.restarts;
  return report;
}

}  // namespace mba_vo
