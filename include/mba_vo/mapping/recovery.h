#pragma once

#include <memory>
#include <optional>

#include "mba_vo/mapping/local_map.h"
#include "mba_vo/relocalization/relocalizer.h"
#include "mba_vo/tracking/lost_timer.h"

namespace mba_vo {

/// What is done about a tracker that is lost: for how long it has been, and the search for it among the keyframes.
class Recovery {
 public:
  explicit Recovery(const MapperConfig& config) : config_(config), relocalizer_(config.relocalizer, config.tracker) {}

  /// Keeps a new keyframe.
  void keep(const Reference& keyframe, const Frame& frame) { archive().add(keyframe, frame); }
  /// What is known of a keyframe by now, if it is kept: while it is in the window, that changes all the time.
  void update(const Reference& keyframe) { archive().update(keyframe); }
  /// The same of all keyframes in the window of `map`, which is what a lost camera is looked for in.
  void update(const LocalMap& map);

  /// Takes a frame that the tracker lost.
  void lose(const TrackedFrame& frame);
  /// A frame in which a camera that is lost cannot be looked for: its time does not count.
  void passOver(const TrackedFrame& frame);
  /// It is time to look for it: lost for long enough, and nothing is on its way to the tracker.
  bool isDue(const TrackedFrame& frame) const;
  /// Among the keyframes kept. `usual_error`: of frames in this map [px].
  std::optional<Relocalizer::Found> search(const TrackedFrame& frame, double usual_error);
  /// The keyframes kept.
  KeyframeArchive& archive() { return relocalizer_.archive(); }
  const KeyframeArchive& archive() const { return relocalizer_.archive(); }
  /// With images that show something [s].
  double lostSeconds() const { return clock_.seconds(); }
  bool isLostForGood() const { return lostSeconds() >= config_.restart_after_lost; }
  /// The tracker has a pose again.
  void find();
  void reset();

  /// Another window of a map, which begins with a keyframe that has left the old one, or is of an earlier run.
  std::unique_ptr<LocalMap> windowAt(const Relocalizer::Found& found, LocalMap::Identity map, TrajectoryStore& store,
                                     CalibrationEstimator& calibration) const;

 private:
  MapperConfig config_;
  Relocalizer relocalizer_;
  LostTimer clock_;
  std::optional<std::int64_t> found_ns_;  // when the camera was found, until the tracker knows
};

}  // namespace mba_vo
