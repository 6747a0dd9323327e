#include "mba_vo/tracking/keyframe_policy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace mba_vo {
namespace {

constexpr double kUrgentNeed = 2.2;  // no blur keeps a frame from being taken any longer
// Of 4, 6 and 8: a map that began wrong is soonest right with 6 (docs/decisions/2026-11-30-keyframes-by-parallax.md).
constexpr std::size_t kGrownWindow = 6;  // keyframes
constexpr std::size_t kLeastWindow = 2;  // keyframes: first depths rest on two views, whether or not both are kept

}  // namespace

double KeyframePolicy::need(const Reference& reference, const FrameMeasures& frame,
                            const AffineBrightness& brightness) const {
  const double invisible = (1.0 - frame.visible_fraction) / std::max(1.0 - config_.min_visible_fraction, 1e-3);
  const double gain_change = std::abs(brightness.a - reference.brightness.a) / config_.brightness_change;
  return frame.flow_px / config_.flow_px + frame.parallax_px / config_.parallax_px + invisible * invisible * invisible +
         gain_change;
}

bool KeyframePolicy::isUrgent(const Reference& reference, const FrameMeasures& frame,
                              const AffineBrightness& brightness) const {
  return need(reference, frame, brightness) > kUrgentNeed;
}

/// That a frame must exceed to be taken, at first.
double KeyframePolicy::neededFor(const FrameMeasures& frame) const {
  return 1.0 + config_.patience * std::max(0.0, frame.blur_length_px / std::max(config_.sharp_blur_px, 0.1) - 1.0);
}

bool KeyframePolicy::takes(const Reference& reference, const FrameMeasures& frame,
                           const AffineBrightness& brightness) const {
  return need(reference, frame, brightness) > std::min(neededFor(frame), kUrgentNeed);
}

bool KeyframePolicy::helpsYoungMap(const Reference& reference, const FrameMeasures& frame,
                                   const AffineBrightness& brightness) const {
  if (reference.metric) return false;  // depths that were measured in metres need no baselines
  const std::size_t keyframes = std::clamp(reference.T_map_keyframe.size(), kLeastWindow, kGrownWindow);
  KeyframePolicyConfig young = config_;
  young.parallax_px *= static_cast<double>(keyframes) / kGrownWindow;
  return KeyframePolicy(young).need(reference, frame, brightness) > neededFor(frame);
}

}  // namespace mba_vo
