#pragma once

#include "mba_vo/tracking/frame_measures.h"

namespace mba_vo {

struct KeyframePolicyConfig {
  double flow_px = 55.0;
  double parallax_px = 27.0;
  double brightness_change = 0.5;
  double min_visible_fraction = 0.7;
  double sharp_blur_px = 2.0;
  double patience = 0.3;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("flow_px", c.flow_px, 1.0, 1000.0, "rms image motion since the keyframe that asks for a new one [px]");
    v("parallax_px", c.parallax_px, 1.0, 1000.0, "the same of the part caused by translation [px]");
    v("brightness_change", c.brightness_change, 0.01, 10.0, "change of log brightness that asks for a new keyframe");
    v("min_visible_fraction", c.min_visible_fraction, 0.0, 1.0, "visible points that ask for a new keyframe");
    v("sharp_blur_px", c.sharp_blur_px, 0.0, 100.0, "blur up to which a frame is taken at once [px]");
    v("patience", c.patience, 0.0, 10.0, "how much more need a frame with twice that blur must have to be taken");
  }
};

/// Decides which frames become keyframes: parallax, image motion, visibility and brightness make the need; a blurred
/// frame must be needed more than a sharp one.
class KeyframePolicy {
 public:
  explicit KeyframePolicy(const KeyframePolicyConfig& config) : config_(config) {}

  /// How much a new keyframe is needed; 1 = take the next sharp frame.
  double need(const Reference& reference, const FrameMeasures& frame, const AffineBrightness& brightness) const;
  /// The view is being left: no blur, and no other work, keeps the next frame from being taken.
  bool isUrgent(const Reference& reference, const FrameMeasures& frame, const AffineBrightness& brightness) const;
  bool takes(const Reference& reference, const FrameMeasures& frame, const AffineBrightness& brightness) const;
  /// Whether it is taken for the sake of a map of so few keyframes that their depths rest on short baselines, which the
  /// next is to lengthen: less parallax asks for it, but blur keeps it from being taken for as long as it takes.
  bool helpsYoungMap(const Reference& reference, const FrameMeasures& frame, const AffineBrightness& brightness) const;

 private:
  double neededFor(const FrameMeasures& frame) const;

  KeyframePolicyConfig config_;
};

}  // namespace mba_vo
