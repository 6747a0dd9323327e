#include "mba_vo/mapping/mapping_phase.h"

#include <cstddef>

namespace mba_vo {

// Names are in the order of the enumerations.
const char* toString(MappingPhase phase) {
  constexpr const char* kNames[] = {"initializing", "locating", "mapping", "refining", "lost"};
  return kNames[static_cast<std::size_t>(phase)];
}

const char* toString(MappingEvent event) {
  constexpr const char* kNames[] = {"map begins", "map loaded",    "not found",   "keyframe",  "keyframe refined",
                                    "frame lost", "frame tracked", "found again", "map closed"};
  return kNames[static_cast<std::size_t>(event)];
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
