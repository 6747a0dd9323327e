#include "mba_vo/mapping/mapping_phase.h"

namespace mba_vo {

const char* toString(MappingPhase phase) {
  switch (phase) {
    case MappingPhase::kInitializing:
      return "initializing";
    case MappingPhase::kLocating:
      return "locating";
    case MappingPhase::kMapping:
      return "mapping";
    case MappingPhase::kRefining:
      return "refining";
    case MappingPhase::kLost:
      return "lost";
  }
  return "";
}

const char* toString(MappingEvent event) {
  switch (event) {
    case MappingEvent::kMapBegins:
      return "map begins";
    case MappingEvent::kMapLoaded:
      return "map loaded";
    case MappingEvent::kNotFound:
      return "not found";
    case MappingEvent::kKeyframe:
      return "keyframe";
    case MappingEvent::kKeyframeRefined:
      return "keyframe refined";
    case MappingEvent::kFrameLost:
      return "frame lost";
    case MappingEvent::kFrameTracked:
      return "frame tracked";
    case MappingEvent::kFoundAgain:
      return "found again";
    case MappingEvent::kMapClosed:
      return "map closed";
  }
  return "";
}

const PhaseTable<MappingPhase, MappingEvent>& mappingTable() {
  using P = MappingPhase;
  using E = MappingEvent;
  static const PhaseTable<P, E> kTable = {
      {P::kInitializing, E::kMapBegins, P::kMapping},
      {P::kInitializing, E::kMapLoaded, P::kLocating},
      {P::kInitializing, E::kMapClosed, P::kInitializing},

      {P::kLocating, E::kMapBegins, P::kMapping},
      {P::kLocating, E::kNotFound, P::kInitializing},
      {P::kLocating, E::kMapClosed, P::kInitializing},

      {P::kMapping, E::kKeyframe, P::kRefining},
      {P::kMapping, E::kFrameLost, P::kLost},
      {P::kMapping, E::kMapClosed, P::kInitializing},

      {P::kRefining, E::kKeyframeRefined, P::kMapping},
      {P::kRefining, E::kMapClosed, P::kInitializing},

      {P::kLost, E::kFrameLost, P::kLost},
      {P::kLost, E::kFrameTracked, P::kMapping},
      {P::kLost, E::kFoundAgain, P::kMapping},
      {P::kLost, E::kMapClosed, P::kInitializing},
  };
  return kTable;
}

}  // namespace mba_vo
