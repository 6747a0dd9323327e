#pragma once

#include "mba_vo/mapping/phase_table.h"

namespace mba_vo {

/// What the mapper is doing with the frames that come.
enum class MappingPhase {
  kInitializing,  // there is no map: they are searched for a first one
  kLocating,      // there is no window: the camera is looked for in the map of an earlier run
  kMapping,       // they refine depths, and may become keyframes
  kRefining,      // as mapping, while between them the window is optimised with its newest keyframe
  kLost           // the tracker has lost the camera: it is looked for among the keyframes
};

/// What may change that.
enum class MappingEvent {
  kMapBegins,        // the first one was found, or the camera in the earlier one
  kMapLoaded,        // of an earlier run, or it is to be looked in again
  kNotFound,         // the camera, in the earlier map
  kKeyframe,         // has been inserted; a draft of it went to the tracker
  kKeyframeRefined,  // or has to do with what there is
  kFrameLost,        // by the tracker
  kFrameTracked,     // by a tracker that had lost the camera
  kFoundAgain,       // the camera, by a keyframe
  kMapClosed         // lost for good, wrong, or given up for a reset
};

const char* toString(MappingPhase phase);
const char* toString(MappingEvent event);

/// `docs/how_it_works.md` shows the same table.
const PhaseTable<MappingPhase, MappingEvent>& mappingTable();

}  // namespace mba_vo
