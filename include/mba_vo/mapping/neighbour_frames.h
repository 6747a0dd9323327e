#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "mba_vo/deblur/neighbour.h"
#include "mba_vo/mapping/local_map.h"
#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// The last few tracked frames, for a keyframe among them that is deblurred with the help of another one. A keyframe is
/// made when the frame after it has been tracked, so that there are two before it and one after.
class NeighbourFrames {
 public:
  /// The next frame, or one of the last that was tracked again.
  void add(const TrackedFrameConstPtr& frame);
  /// Frames at most two before or after the keyframe that was made of frame `sequence`: of its map, well tracked, and
  /// with known exposures. Of a map's first keyframe there are none.
  std::vector<DeblurNeighbour> around(const Reference& keyframe, std::uint64_t sequence, const LocalMap& map) const;
  void clear() { frames_.clear(); }

 private:
  std::deque<TrackedFrameConstPtr> frames_;  // by time
};

}  // namespace mba_vo
