#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "mba_vo/deblur/deblur_queue.h"
#include "mba_vo/mapping/local_map.h"
#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/mapping/neighbour_frames.h"
#include "mba_vo/relocalization/keyframe_archive.h"

namespace mba_vo {

/// A keyframe of the map that has been deblurred.
struct SharpKeyframe {
  KeyframeId keyframe_id = 0;
  FrameConstPtr frame;                        // as it came
  std::shared_ptr<const ImagePyramid> image;  // sharp
  bool in_map = false;                        // it has taken the place of the blurred one
};

/// Gives keyframes to the deblurrer while the map goes on with their blurred images, and puts the sharp ones in their
/// places: in the window, and among the keyframes that a lost camera is found by. A sharp image with which the keyframe
/// would explain the others of the window worse does not get into the map. Where the configuration names no method,
/// keyframes are deblurred along their trajectories while somebody looks, and the map goes on with the blurred ones.
class KeyframeDeblurring {
 public:
  /// `deblurrer`: null for the one that the configuration names.
  KeyframeDeblurring(const MapperConfig& config, std::shared_ptr<const Deblurrer> deblurrer);

  /// Whether anybody looks at sharp keyframes. While nobody does, those that are not for the map are not made.
  void setWatched(bool watched);
  /// With every tracked frame, also one that was tracked again: it may help with a keyframe near by.
  void remember(const TrackedFrameConstPtr& frame);
  /// A new keyframe of the map. `motion`: relative to it. `measured_velocity`: by another measurement, if there is one.
  /// An image without exposure time is sharp already.
  void offer(const LocalMap& map, const Reference& keyframe, const FrameConstPtr& frame,
             const ExposureTrajectory& motion, const std::optional<Vector6>& measured_velocity);
  /// With every image, before it is used: puts a sharp image that is ready into its place if it is good enough.
  std::optional<SharpKeyframe> takeReady(LocalMap& map, KeyframeArchive& archive);
  /// With every image, after it has been used: begins with another keyframe if it is time to.
  void beginNext(const LocalMap& map, std::int64_t now_ns);
  /// The map is no more.
  void forgetMap();

  DeblurCounts counts() const;

 private:
  void begin(std::shared_ptr<const Deblurrer> deblurrer);
  bool isIdle() const { return !queue_ || (for_display_ && !watched_); }

  MapperConfig config_;
  bool for_display_ = false;  // and not for the map
  bool watched_ = false;
  std::optional<DeblurQueue> queue_;           // none if keyframes are not deblurred
  std::optional<NeighbourFrames> neighbours_;  // none if keyframes are deblurred by themselves
  std::uint64_t in_map_ = 0;
};

}  // namespace mba_vo
