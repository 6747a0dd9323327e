#pragma once

#include <functional>
#include <vector>

#include "mba_vo/mapping/initializer.h"
#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

/// Tracks the frames that were buffered before there was a map, in one direction of time from a known frame on.
class Replay {
 public:
  /// `start`: trajectory of a frame at `start_ns` relative to the reference that tracking begins with.
  Replay(const MapperConfig& config, const InitialMap& initial, const ExposureTrajectory& start, std::int64_t start_ns);

  /// Tracks `frame`; the initial map's own pose of it, if there is one, is the guess.
  TrackedFrame track(const Reference& reference, const FrameConstPtr& frame);
  /// Goes on relative to another reference of the same map.
  void changeReference(const SE3& T_new_old);
  /// Of the last tracked frame, relative to the newest reference.
  const ExposureTrajectory& last() const { return last_; }
  std::int64_t lastNs() const { return last_ns_; }

 private:
  TrackingGuess guessFor(const FrameConstPtr& frame) const;

  Tracker tracker_;
  double unknown_exposure_;
  const InitialMap& initial_;
  SE3 T_reference_initial_;  // the initial map's reference relative to the present one
  ExposureTrajectory last_;
  std::int64_t last_ns_;
  AffineBrightness brightness_;
};

}  // namespace mba_vo
