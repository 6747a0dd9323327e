#pragma once

#include "mba_vo/tracking/reference.h"
#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// Options of the blur-aware tracker. `describe` names every option once, for YAML, ROS parameters and documentation.
struct TrackerConfig {
  int pyramid_levels = 5;
  int max_points = 440;
  int max_iterations = 12;
  double huber_threshold = 9.0;
  double sample_spacing_px = 1.25;
  int max_samples = 64;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("pyramid_levels", c.pyramid_levels, 1, 8, "image pyramid levels");
    v("max_points", c.max_points, 20, 5000, "patches aligned per frame");
    v("max_iterations", c.max_iterations, 1, 100, "Levenberg-Marquardt iterations per level");
    v("huber_threshold", c.huber_threshold, 0.1, 255.0, "Huber threshold of the residual [grey levels]");
    v("sample_spacing_px", c.sample_spacing_px, 0.1, 10.0, "spacing of samples along the blur path [px]");
    v("max_samples", c.max_samples, 1, 256, "most samples along the blur path");
  }
};

/// Blur-aware direct image alignment of one frame to one reference (Eq. 8 of the paper). Stateless.
class Tracker {
 public:
  explicit Tracker(const TrackerConfig& config) : config_(config) {}

  /// `guess` is relative to the reference; a guess with exposure 0 is aligned as a sharp image.
  TrackedFrame track(const Reference& reference, const FrameConstPtr& frame, const ExposureTrajectory& guess) const;

 private:
  TrackerConfig config_;
};

}  // namespace mba_vo
