#pragma once

#include "mba_vo/mapping/phase_table.h"

namespace mba_vo {

/// What the tracker is doing. Every phase says what becomes of a new image and what is done while none comes.
enum class TrackingPhase {
  kNoMap,       // images are kept for the first reference; the orientation is tracked
  kCatchingUp,  // frames that were never tracked wait; a new image waits behind them
  kTracking,    // a new image is tracked at once
  kRevising,    // frames are tracked once more, against a keyframe that they see better; a new image goes ahead of them
  kGoingBack,   // as revising, but where the camera is now is not known: a new image waits
  kLost         // as tracking, but the last image could not be aligned
};

/// What may change that.
enum class TrackingEvent {
  kMapBegins,     // the first reference of a map, with a hint where to begin
  kMapClosed,     // by the mapper
  kKeyframe,      // another reference of the map, no frame is worth another look
  kRevise,        // another reference, frames before the newest one see it better
  kGoBack,        // the same, and the newest one was lost
  kImageWaits,    // a new image could not be tracked at once
  kNothingWaits,  // the last frame that waited has been tracked
  kFallBehind,    // images come in faster than they can be tracked
  kGoOn,          // frames still to be revised are left as they are
  kFrameTracked,  // with nothing waiting
  kFrameLost,     // the same
  kReset
};

const char* toString(TrackingPhase phase);
const char* toString(TrackingEvent event);

/// `docs/how_it_works.md` shows the same table.
const PhaseTable<TrackingPhase, TrackingEvent>& trackingTable();

}  // namespace mba_vo
