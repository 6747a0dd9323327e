#pragma once

#include <string>

#include "mba_vo/odometry/tracker_pipeline.h"

namespace mba_vo {

/// Says on the console how the tracking goes: each thing once, when it begins.
class TrackerConsole {
 public:
  /// To be called with every step.
  void tell(const TrackerStep& step);

 private:
  void tellLoss(const TrackerStep& step, const std::string& why);
  void tellCatchingUp(const TrackerStep& step);

  TrackingPhase phase_ = TrackingPhase::kNoMap;
  bool is_lost_ = false;
  bool catches_up_ = false;  // with what waited for the map in use
  bool leaves_out_ = false;  // frames, for that
};

}  // namespace mba_vo
