#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "mba_vo/odometry/tracking_state.h"

namespace mba_vo {

/// The newest frames, from the first one on that saw its reference badly: they are tracked again once there is a
/// reference that they see better.
class RecentFrames {
 public:
  struct Entry {
    FrameConstPtr frame;
    bool in_time = false;  // its first result came when the frame did
    bool mapped = false;   // the mapper has used it
    double need = 0.0;     // of a keyframe when it was tracked; infinite if it was lost
    TrackingState before;  // what it was predicted from, relative to the reference in use
  };

  /// `badly_seen`: this frame is worth another look. Nothing is kept until there is such a frame.
  void add(const Entry& entry, bool badly_seen);
  /// Goes on relative to another reference.
  void changeReference(const SE3& T_new_old);
  /// Hands out the frames after `mid_exposure_ns`, by time, and forgets them all.
  std::vector<Entry> takeAfter(std::int64_t mid_exposure_ns);
  void clear() { entries_.clear(); }

 private:
  std::deque<Entry> entries_;  // by time
};

}  // namespace mba_vo
