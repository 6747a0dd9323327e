#include <algorithm>
#include <utility>

#include "mba_vo/image/parallel_for.h"
#include "mba_vo/mapping/freed_memory.h"
#include "mba_vo/mapping/local_map.h"
#include "mba_vo/mapping/point_activator.h"
#include "mba_vo/solver/point_chunks.h"
#include "mba_vo/window/motion_alignment.h"
#include "stage_clock.h"

namespace mba_vo {
namespace {

constexpr int kCalibrationKeyframes = 2;   // least number in a window that tells about the calibration
constexpr int kCalibrationSteps = 3;       // at most, with one keyframe
constexpr std::uint64_t kSlopeStride = 2;  // a point's slope is updated with every so many keyframes
constexpr int kDeparturesPerReturn = 8;    // of keyframes, until the memory they leave is given back

}  // namespace

bool LocalMap::refineWindow(KeyframeReport& report) {
  const StageClock::time_point begin = StageClock::now();
  switch (refinement_.next) {
    case Refinement::Piece::kSelect:
      selectNewestPoints(report);
      break;
    case Refinement::Piece::kBegin:
      beginOptimization(report);
      break;
    case Refinement::Piece::kIterate:
      iterate(report);
      break;
    case Refinement::Piece::kConclude:
      budget_.keepUp();
      conclude(report);
      break;
  }
  report.total_ms += millisecondsSince(begin);
  return refinement_.next != Refinement::Piece::kSelect;
}

void LocalMap::refineWindowNoFurther(KeyframeReport& report) {
  const StageClock::time_point begin = StageClock::now();
  if (refinement_.iterations == 0) budget_.fallBehind();
  // What has not begun is left to the next keyframe: to begin costs more than all the rest.
  if (refinement_.next == Refinement::Piece::kIterate) endOptimization(report);
  if (refinement_.next == Refinement::Piece::kSelect) selectNewestPoints(report);
  conclude(report);
  report.total_ms += millisecondsSince(begin);
}

/// At once, so that depths are searched in the very next frames: on fast turns there are few that show them.
void LocalMap::selectNewestPoints(KeyframeReport& report) {
  const StageClock::time_point stage = StageClock::now();
  selectImmaturePoints(keyframes_.at(newestKeyframe()));
  report.selection_ms = millisecondsSince(stage);
  refinement_.next = Refinement::Piece::kBegin;
}

void LocalMap::adoptRevisedMotion() {
  if (const auto motion = std::exchange(revised_motion_, std::nullopt)) window_.setMotion(newestKeyframe(), *motion);
}

void LocalMap::beginOptimization(KeyframeReport& report) {
  adoptRevisedMotion();
  updateSlopes();
  alignBlurred(report.blur_length_px);
  const StageClock::time_point stage = StageClock::now();
  window_.beginOptimization(config_.window.max_iterations);
  report.optimisation_ms += millisecondsSince(stage);
  refinement_.next = Refinement::Piece::kIterate;
}

void LocalMap::iterate(KeyframeReport& report) {
  StageClock::time_point stage = StageClock::now();
  const bool more = window_.iterate();
  ++refinement_.iterations;
  if (!more) endOptimization(report);
  storePoses();
  report.optimisation_ms += millisecondsSince(stage);
  if (more) return;
  stage = StageClock::now();
  refinement_.next = refineImaging(report) ? Refinement::Piece::kIterate : Refinement::Piece::kConclude;
  report.calibration_ms += millisecondsSince(stage);
}

void LocalMap::endOptimization(KeyframeReport& report) {
  const WindowSummary summary = window_.endOptimization();
  storePoses();
  if (refinement_.calibration_steps > 0) return;
  report.depths = summary.depths;
  report.residuals = summary.residuals;
  report.rms = summary.rms;
}

void LocalMap::conclude(KeyframeReport& report) {
  const StageClock::time_point stage = StageClock::now();
  adoptRevisedMotion();
  marginalizeKeyframes();
  report.marginalisation_ms = millisecondsSince(stage);
  report.points = window_.pointCount();
  report.depth_search_ms = std::exchange(depth_search_ms_, 0.0);
  refinement_ = {};
}

/// Of half of the points, by turns: a slope, which most points have from their activation on, changes but slowly.
void LocalMap::updateSlopes() {
  const std::vector<WindowPoint> points = window_.points();
  const std::vector<KeyframeId> hosts = window_.keyframes();
  std::vector<std::optional<SurfaceSlopes>> of_host(hosts.size());
  parallelFor(hosts.size(), [&](std::size_t i) {
    of_host[i].emplace(window_.camera(hosts[i]), pointsSeenBy(window_, points, hosts[i]));
  });
  std::vector<std::optional<Eigen::Vector2d>> slopes(points.size());
  PointChunks(points.size()).forEachRow([&](std::size_t /*chunk*/, std::size_t i) {
    const WindowPoint& point = points[i];
    if ((point.id + newestKeyframe()) % kSlopeStride != 0) return;
    const auto host = std::lower_bound(hosts.begin(), hosts.end(), point.host) - hosts.begin();
    const SurfaceSlopes& surface = *of_host[static_cast<std::size_t>(host)];
    slopes[i] = surface.at(point.pixel, point.inverse_depth, kResidualVariance * point.variance);
  });
  window_.setSlopes(slopes);
}

/// One step of the calibration. Returns whether one was taken: the window is then to be optimised with it.
bool LocalMap::refineImaging(KeyframeReport& report) {
  const bool rolling = window_.camera(newestKeyframe()).row_time != 0.0;
  if (!config_.refine_calibration && !rolling) return false;
  if (static_cast<int>(keyframes_.size()) < kCalibrationKeyframes) return false;
  if (refinement_.calibration_steps >= kCalibrationSteps) return false;
  report.calibration = {calibration_.correction(), window_.refineRowMotions()};
  if (!config_.refine_calibration || !calibration_.add(report.calibration->system)) {
    if (calibration_.isSettled()) window_.settleCorrection();
    return false;
  }
  ++refinement_.calibration_steps;
  window_.setCorrection(calibration_.correction());
  window_.beginOptimization(config_.window.max_iterations);
  return true;
}

void LocalMap::marginalizeKeyframes() {
  const std::vector<KeyframeId> leaving = window_.keyframesToMarginalize();
  for (const KeyframeId id : leaving) just_departed_.push_back({makeReference(id), frame(id)});
  for (const KeyframeId id : leaving) {
    keepForDisplay(id);
    window_.marginalize(id);
    store_.attachKeyframe(id_, id, keyframes_.upper_bound(id)->first);
    keyframes_.erase(id);
    if (++departed_ % kDeparturesPerReturn == 0) returnFreedMemory();
  }
}

std::vector<ArchivedKeyframeConstPtr> LocalMap::archived(std::size_t most) const {
  const std::size_t count = std::min(most, keyframes_.size());
  std::vector<ArchivedKeyframeConstPtr> newest;
  for (auto k = std::prev(keyframes_.end(), static_cast<std::ptrdiff_t>(count)); k != keyframes_.end(); ++k) {
    newest.push_back(archiveForLoops(*makeReference(k->first), *k->second.frame));
  }
  return newest;
}

}  // namespace mba_vo
