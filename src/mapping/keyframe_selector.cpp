#include "mba_vo/mapping/keyframe_selector.h"

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
  motion_.add(frame->frame->mid_exposure_ns, T_map_camera, observedMotion(*frame));
  if (std::exchange(hurried_, false) && motion_.knowsBothSides()) motion_afterwards_ = motion_.motionOfMiddle();
  if (candidate_ && !ready_) {
    taken_motion_ = motion_.motionOfMiddle();
    ready_ = true;
  }
  if (candidate_ && !busy) return takeReady();
  ExposureTrajectory in_newest = frame->trajectory;
  in_newest.T_reference_mid = newest.T_map_reference.inverse() * T_map_camera;
  const FrameMeasures measures = measureFrame(newest, in_newest);
  const bool explained_badly = isExplainedBadly(*frame, newest.id.keyframe_id);
  const bool helps = !busy && policy_.helpsYoungMap(newest, measures, frame->brightness);
  const bool taken = helps || explained_badly || policy_.takes(newest, measures, frame->brightness);
  if (!candidate_ && taken) candidate_ = frame;
  return candidate_ && policy_.isUrgent(newest, measures, frame->brightness) ? takeNow() : nullptr;
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
  hurried_ = candidate_ && !ready_;
  if (!ready_) taken_motion_ = motion_.motionOfLast();
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
  hurried_ = false;
  motion_afterwards_.reset();
  candidate_.reset();
  ready_ = false;
  first_error_.reset();
}

}  // namespace mba_vo
