#pragma once

#include <optional>
#include <vector>

#include "mba_vo/relocalization/keyframe_archive.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

struct RelocalizerConfig {
  int max_keyframes = 60;
  int trials_per_frame = 3;
  double min_inlier_fraction = 0.75;
  double min_visible_fraction = 0.35;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("max_keyframes", c.max_keyframes, 0, 100000, "keyframes kept to find a lost camera again, 0 = none");
    v("trials_per_frame", c.trials_per_frame, 1, 1000,
      "keyframes that a lost frame is aligned to, the likeliest first");
    v("min_inlier_fraction", c.min_inlier_fraction, 0.0, 1.0, "inlier pixels with which a lost frame counts as found");
    v("min_visible_fraction", c.min_visible_fraction, 0.0, 1.0, "points of the keyframe that it must see");
  }
};

/// Finds a lost camera by the keyframes of its map: small images propose, blur-aware alignment verifies, and the next
/// frames must agree, which took no part.
class Relocalizer {
 public:
  Relocalizer(const RelocalizerConfig& config, const TrackerConfig& tracker);

  KeyframeArchive& archive() { return archive_; }
  const KeyframeArchive& archive() const { return archive_; }

  struct Found {
    KeyframeId keyframe = 0;
    FrameConstPtr keyframe_frame;  // the keyframe's image, restored
    TrackingHint hint;             // about the frame just given, relative to the keyframe
  };
  /// `usual_error`: pixel error that frames of this map usually have. Frames must come by time.
  std::optional<Found> find(const FrameConstPtr& frame, double usual_error);

  /// Forgets what was found so far, not the keyframes.
  void restart();

 private:
  /// A pose that some frames in a row agree with.
  struct Suspicion {
    KeyframeId keyframe = 0;
    FrameConstPtr keyframe_frame;
    std::shared_ptr<const Reference> reference;
    ExposureTrajectory trajectory;
    std::int64_t mid_exposure_ns = 0;
    int agreeing = 1;  // frames
  };
  std::vector<PlaceCandidate> candidates(const ImagePyramid& image) const;
  bool isGood(const TrackedFrame& tracked, double usual_error) const;
  ExposureTrajectory start(const PlaceCandidate& candidate, const Frame& frame) const;
  std::optional<Suspicion> align(const PlaceCandidate& candidate, const FrameConstPtr& frame, double usual_error) const;
  /// Follows the suspicion to this frame; false if it was wrong.
  bool confirm(const FrameConstPtr& frame, double usual_error);

  RelocalizerConfig config_;
  double unknown_exposure_;  // [s]
  Tracker tracker_;
  KeyframeArchive archive_;
  std::optional<Suspicion> suspicion_;
  std::size_t first_candidate_ = 0;  // of the next frame: those before were tried in vain just now
};

}  // namespace mba_vo
