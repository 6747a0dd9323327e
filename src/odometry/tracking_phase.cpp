#include "mba_vo/odometry/tracking_phase.h"

#include <cstddef>

namespace mba_vo {

// Names are in the order of the enumerations.
const char* toString(TrackingPhase phase) {
  constexpr const char* kNames[] = {"no map", "catching up", "tracking", "revising", "going back", "lost"};
  return kNames[static_cast<std::size_t>(phase)];
}

const char* toString(TrackingEvent event) {
  constexpr const char* kNames[] = {"map begins", "map closed",    "keyframe",      "revise",
                                    "go back",    "image waits",   "nothing waits", "fall behind",
                                    "go on",      "frame tracked", "frame lost",    "reset"};
  return kNames[static_cast<std::size_t>(event)];
}

const PhaseTable<TrackingPhase, TrackingEvent>& trackingTable() {
  using P = TrackingPhase;
  using E = TrackingEvent;
  static const PhaseTable<P, E> kTable = {
      {P::kNoMap, E::kMapBegins, P::kCatchingUp},
      {P::kNoMap, E::kReset, P::kNoMap},

      {P::kCatchingUp, E::kMapBegins, P::kCatchingUp},
      {P::kCatchingUp, E::kMapClosed, P::kNoMap},
      {P::kCatchingUp, E::kKeyframe, P::kCatchingUp},
      {P::kCatchingUp, E::kGoBack, P::kCatchingUp},
      {P::kCatchingUp, E::kImageWaits, P::kCatchingUp},
      {P::kCatchingUp, E::kNothingWaits, P::kTracking},
      {P::kCatchingUp, E::kReset, P::kNoMap},

      {P::kTracking, E::kMapBegins, P::kCatchingUp},
      {P::kTracking, E::kMapClosed, P::kNoMap},
      {P::kTracking, E::kKeyframe, P::kTracking},
      {P::kTracking, E::kRevise, P::kRevising},
      {P::kTracking, E::kFallBehind, P::kCatchingUp},
      {P::kTracking, E::kFrameTracked, P::kTracking},
      {P::kTracking, E::kFrameLost, P::kLost},
      {P::kTracking, E::kReset, P::kNoMap},

      {P::kRevising, E::kMapBegins, P::kCatchingUp},
      {P::kRevising, E::kMapClosed, P::kNoMap},
      {P::kRevising, E::kKeyframe, P::kRevising},
      {P::kRevising, E::kRevise, P::kRevising},
      {P::kRevising, E::kFrameLost, P::kGoingBack},
      {P::kRevising, E::kGoOn, P::kTracking},
      {P::kRevising, E::kNothingWaits, P::kTracking},
      {P::kRevising, E::kReset, P::kNoMap},

      {P::kGoingBack, E::kMapBegins, P::kCatchingUp},
      {P::kGoingBack, E::kMapClosed, P::kNoMap},
      {P::kGoingBack, E::kKeyframe, P::kGoingBack},
      {P::kGoingBack, E::kGoBack, P::kGoingBack},
      {P::kGoingBack, E::kImageWaits, P::kCatchingUp},
      {P::kGoingBack, E::kNothingWaits, P::kTracking},
      {P::kGoingBack, E::kReset, P::kNoMap},

      {P::kLost, E::kMapBegins, P::kCatchingUp},
      {P::kLost, E::kMapClosed, P::kNoMap},
      {P::kLost, E::kKeyframe, P::kLost},
      {P::kLost, E::kGoBack, P::kGoingBack},
      {P::kLost, E::kFrameTracked, P::kTracking},
      {P::kLost, E::kFrameLost, P::kLost},
      {P::kLost, E::kReset, P::kNoMap},
  };
  return kTable;
}

}  // namespace mba_vo
