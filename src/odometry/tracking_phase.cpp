#include "mba_vo/odometry/tracking_phase.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace mba_vo {

const char* toString(TrackingPhase phase) {
  switch (phase) {
    case TrackingPhase::kNoMap:
      return "no map";
    case TrackingPhase::kCatchingUp:
      return "catching up";
    case TrackingPhase::kTracking:
      return "tracking";
    case TrackingPhase::kRevising:
      return "revising";
    case TrackingPhase::kGoingBack:
      return "going back";
    case TrackingPhase::kLost:
      return "lost";
  }
  return "";
}

const char* toString(PhaseEvent event) {
  switch (event) {
    case PhaseEvent::kMapBegins:
      return "map begins";
    case PhaseEvent::kMapClosed:
      return "map closed";
    case PhaseEvent::kKeyframe:
      return "keyframe";
    case PhaseEvent::kRevise:
      return "revise";
    case PhaseEvent::kGoBack:
      return "go back";
    case PhaseEvent::kImageWaits:
      return "image waits";
    case PhaseEvent::kNothingWaits:
      return "nothing waits";
    case PhaseEvent::kGoOn:
      return "go on";
    case PhaseEvent::kFrameTracked:
      return "frame tracked";
    case PhaseEvent::kFrameLost:
      return "frame lost";
    case PhaseEvent::kReset:
      return "reset";
  }
  return "";
}

const std::vector<PhaseTransition>& phaseTransitions() {
  using P = TrackingPhase;
  using E = PhaseEvent;
  static const std::vector<PhaseTransition> kTransitions = {
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
  return kTransitions;
}

TrackingPhase nextPhase(TrackingPhase phase, PhaseEvent event) {
  const std::vector<PhaseTransition>& all = phaseTransitions();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const PhaseTransition& t) { return t.from == phase && t.event == event; });
  if (found == all.end()) {
    throw std::logic_error(std::string("tracking phase '") + toString(phase) + "': '" + toString(event) +
                           "' cannot happen");
  }
  return found->to;
}

}  // namespace mba_vo
