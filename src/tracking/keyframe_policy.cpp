#include "mba_vo/tracking/keyframe_policy.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

constexpr double kUrgentNeed = 2.2;  // no blur keeps a frame from being taken any longer
// Of 4, 6 and 8: a map that began wrong is soonest right with 6 (docs/decisions/2026-11-30-young-maps.md).
constexpr double kGrownWindow = 6.0;  // keyframes

/// The share of the parallax that a grown map allows: depths of few keyframes rest on short baselines, which the next
/// keyframe is to lengthen. Depths that were measured in metres do not.
double allowedParallax(const Reference& reference) {
  if (reference.metric || reference.T_map_keyframe.empty()) return 1.0;
  return std::min(1.0, static_cast<double>(reference.T_map_keyframe.size()) / kGrownWindow);
}

}  // namespace

double KeyframePolicy::need(const Reference& reference, const FrameMeasures& frame,
                            const AffineBrightness& brightness) const {
  const double invisible = (1.0 - frame.visible_fraction) / std::max(1.0 - config_.min_visible_fraction, 1e-3);
  const double gain_change = std::abs(brightness.a - reference.brightness.a) / config_.brightness_change;
  const double parallax = frame.parallax_px / (allowedParallax(reference) * config_.parallax_px);
  return frame.flow_px / config_.flow_px + parallax + invisible * invisible * invisible + gain_change;
}

bool KeyframePolicy::isUrgent(const Reference& reference, const FrameMeasures& frame,
                              const AffineBrightness& brightness) const {
  return need(reference, frame, brightness) > kUrgentNeed;
}

bool KeyframePolicy::takes(const Reference& reference, const FrameMeasures& frame,
                           const AffineBrightness& brightness) const {
  const double excess_blur = std::max(0.0, frame.blur_length_px / std::max(config_.sharp_blur_px, 0.1) - 1.0);
  return need(reference, frame, brightness) > std::min(1.0 + config_.patience * excess_blur, kUrgentNeed);
}

}  // namespace mba_vo
