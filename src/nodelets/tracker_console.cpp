#include "tracker_console.h"

#include <string>

#include <ros/console.h>

namespace mba_vo {

void TrackerConsole::tell(const TrackerStep& step) {
  const std::string why = step.message.tracked ? step.message.tracked->reason : step.reason;
  const bool has_map = step.phase != TrackingPhase::kNoMap;
  if (!has_map && phase_ != step.phase && !step.began_anew) ROS_WARN_STREAM("there is no map any more: " << why);
  tellLoss(step, why);
  tellCatchingUp(step);
  phase_ = step.phase;
}

/// While it goes back nobody knows yet; and another map is none in which it would have been found.
void TrackerConsole::tellLoss(const TrackerStep& step, const std::string& why) {
  const bool another_map = phase_ == TrackingPhase::kLost && step.phase == TrackingPhase::kCatchingUp;
  if (step.phase == TrackingPhase::kNoMap || another_map) is_lost_ = false;
  if (step.phase == TrackingPhase::kLost) {
    if (!is_lost_) ROS_WARN_STREAM("the camera is lost, and looked for: " << why);
    is_lost_ = true;
  }
  const bool is_tracking = step.phase == TrackingPhase::kTracking || step.phase == TrackingPhase::kRevising;
  const bool has_pose = step.message.tracked && step.message.tracked->tracked();
  if (!is_lost_ || !is_tracking || !has_pose) return;
  is_lost_ = false;
  ROS_INFO("the camera is found again");
}

void TrackerConsole::tellCatchingUp(const TrackerStep& step) {
  const bool begins = phase_ == TrackingPhase::kNoMap || phase_ == TrackingPhase::kLost;
  if (begins && step.phase == TrackingPhase::kCatchingUp) {
    catches_up_ = true;
    leaves_out_ = false;
    if (phase_ == TrackingPhase::kNoMap) ROS_INFO("there is a map: the images that waited for it are caught up with");
  }
  if (!catches_up_) return;
  if (!step.placed.empty() && !leaves_out_) {
    leaves_out_ = true;
    ROS_WARN("some of the images that wait are left out to catch up: the tracker does not keep up with the camera");
  }
  if (step.phase == TrackingPhase::kCatchingUp) return;
  catches_up_ = false;
  if (step.phase == TrackingPhase::kTracking) ROS_INFO("caught up");
}

}  // namespace mba_vo
