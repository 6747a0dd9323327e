#pragma once

#include <cstdint>
#include <deque>

#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// Motion within an exposure by the poses of the frames before and after it. A blurred image compared with a blurred
/// reference tells only by how much more the one is blurred than the other; the poses at mid-exposure, which hardly
/// depend on the blur, tell the rest.
class KinematicBlur {
 public:
  /// Adds the mid pose of the next frame. Poses must be increasing in time; one that is not is ignored.
  void add(std::int64_t mid_exposure_ns, const SE3& T_map_camera);

  /// xi of the last but one frame for its `exposure` [s]: the mean of the velocities on its two sides. Zero if fewer
  /// than two poses are known, or those on both sides are too far away in time.
  Vector6 xiOfMiddle(double exposure) const;

 private:
  struct Pose {
    std::int64_t ns;
    SE3 T_map_camera;
  };
  std::deque<Pose> poses_;
};

}  // namespace mba_vo
