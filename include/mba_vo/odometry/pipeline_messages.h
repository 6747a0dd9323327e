#pragma once

#include <cstdint>
#include <string>

#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// How the camera is mounted.
struct CameraMount {
  std::string camera_frame;  // of the images
  SE3 T_base_camera;
};

/// Tracker half to mapper half: every frame that was tracked, or could not be.
struct TrackerMessage {
  std::uint64_t session = 0;   // of the tracker; another one with each start and reset, never 0
  bool keep_map = true;        // false: the session began with a reset, the map of an earlier one is to be forgotten
  bool has_reference = false;  // the tracker had one then
  CameraMount mount;           // its pose is left to who sends the message on
  TrackedFrameConstPtr tracked;
};

/// Mapper half to tracker half.
struct MapperMessage {
  std::uint64_t session = 0;  // of the tracker that it is for
  ReferenceConstPtr reference;
};

}  // namespace mba_vo
