#include "mba_vo/mapping/keyframe_selector.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "mba_vo/tracking/frame_measures.h"

namespace mba_vo {
namespace {

// As in DSO. Of 1.5, 2 and 3 it had the least published error (docs/decisions/2026-11-25-keyframes-by-error.md).
constexpr double kMostKeyframeError = 2.0;  // times the error of the first frame

}  // namespace

TrackedFrameConstPtr KeyframeSelector::add(const TrackedFrameConstPtr& frame, const SE3& T_map_camera,
                                           const Reference& newest, bool busy) {
  motion_.add(frame->frame->mid_exposure_ns, T_map_camera, measuredVelocity(*frame));
  if (candidate_ && !ready_) {
    taken_motion_ = motion_.motionOfMiddle();
    ready_ = true;
  }
  if (candidate_ && !busy) return takeReady();
  ExposureTrajectory in_newest = frame->trajectory;
  in_newest.T_reference_mid = newest.T_map_reference.inverse() * T_map_camera;
  const FrameMeasures measures = measureFrame(newest, in_newest);
  const bool explained_badly = isExplainedBadly(*frame, newest.id.keyframe_id);
  if (!candidate_ && (explained_badly || policy_.takes(newest, measures, frame->brightness))) candidate_ = frame;
  const double need = policy_.need(newest, measures, frame->brightness);
  const double next = needOfNext(need, newest.id.keyframe_id);
  // Its motion is not known well before the frame after it has been seen: that is given up when nothing else helps.
  return candidate_ && KeyframePolicy::isUrgent(ready_ ? next : need) ? takeNow() : nullptr;
}

/// If it grows as it did: by the time that a keyframe is inserted the next frame is there.
double KeyframeSelector::needOfNext(double need, KeyframeId newest) {
  const bool comparable = last_need_ && last_need_->keyframe == newest;
  const double growth = comparable ? std::max(0.0, need - last_need_->need) : 0.0;
  last_need_ = {newest, need};
  return need + growth;
}

/// What was tracked against an older keyframe says nothing of the newest.
bool KeyframeSelector::isExplainedBadly(const TrackedFrame& frame, KeyframeId newest) {
  if (frame.reference.keyframe_id != newest) return false;
  if (!first_error_ || first_error_->keyframe != newest) first_error_ = {newest, frame.pixel_error};
  return frame.pixel_error > kMostKeyframeError * first_error_->pixel_error;
}

TrackedFrameConstPtr KeyframeSelector::takeReady() {
  ready_ = false;
  return std::exchange(candidate_, nullptr);
}

TrackedFrameConstPtr KeyframeSelector::takeNow() {
  if (!ready_) taken_motion_ = {motion_.velocityOfLast()};
  return takeReady();
}

void KeyframeSelector::revise(const TrackedFrameConstPtr& frame) {
  if (candidate_ && candidate_->frame->sequence == frame->frame->sequence) candidate_ = frame;
}

void KeyframeSelector::restart(std::int64_t mid_exposure_ns, const SE3& T_map_camera) {
  reset();
  motion_.add(mid_exposure_ns, T_map_camera, std::nullopt);
}

void KeyframeSelector::reset() {
  motion_ = {};
  candidate_.reset();
  ready_ = false;
  first_error_.reset();
  last_need_.reset();
}

}  // namespace mba_vo
