#include <array>
#include <cmath>
#include <cstdio>

#include "mba_vo/image/image_content.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {
namespace {

constexpr double kImplausibleBlur = 0.25;    // of the image's width
constexpr double kImplausibleLogGain = 1.6;  // contrast five times higher or lower than expected
constexpr double kLargestLogGain = 2.5;      // twelve times, if the contrast of the whole image has changed alike ...
constexpr double kVisibleLogGain = 0.7;      // ... up to this

std::string format(const char* text, double value) {
  std::array<char, 128> buffer{};
  std::snprintf(buffer.data(), buffer.size(), text, value);
  return buffer.data();
}

double logRatio(double a, double b) { return a > 0.0 && b > 0.0 ? std::log(a / b) : 0.0; }

/// An image without texture agrees with any reference whose contrast is taken away: so large a change must be that of
/// the exposure, or be seen in the images as a whole.
bool isPlausible(double log_gain, const Reference& reference, const Frame& frame) {
  const double of_exposures = logRatio(frame.exposure.value_or(0.0), reference.exposure.value_or(0.0));
  const double of_images = logRatio(contrast(frame.pyramid), contrast(*reference.pyramid));
  return std::abs(log_gain) < kImplausibleLogGain || std::abs(log_gain - of_exposures) < kImplausibleLogGain ||
         (std::abs(log_gain) < kLargestLogGain && std::abs(log_gain - of_images) < kVisibleLogGain);
}

}  // namespace

void Tracker::judge(const Reference& reference, double log_gain, TrackedFrame& tracked) const {
  tracked.status = TrackingStatus::kTracking;
  if (tracked.points_used < config_.min_patches) {
    tracked.status = TrackingStatus::kLost;
    tracked.reason = format("only %.0f patches of the reference are visible", tracked.points_used);
  } else if (tracked.inlier_fraction < config_.min_inlier_fraction) {
    tracked.status = TrackingStatus::kLost;
    tracked.reason = format("only %.2f of the pixels agree with the reference", tracked.inlier_fraction);
  } else if (!isPlausible(log_gain, reference, *tracked.frame)) {
    tracked.status = TrackingStatus::kLost;
    tracked.reason = format("an implausible change of contrast by %.3g was found", std::exp(log_gain));
  } else if (tracked.measures.blur_length_px > kImplausibleBlur * tracked.frame->pyramid.level(0).camera.width) {
    tracked.status = TrackingStatus::kLost;
    tracked.reason = format("an implausible blur of %.0f px was found", tracked.measures.blur_length_px);
  } else if (tracked.pixel_error > config_.max_pixel_error) {
    tracked.status = TrackingStatus::kLost;
    tracked.reason = format("the image differs from the reference like one shifted by %.1f px", tracked.pixel_error);
  } else if (tracked.inlier_fraction < config_.degraded_inlier_fraction) {
    tracked.status = TrackingStatus::kDegraded;
    tracked.reason = format("only %.2f of the pixels agree with the reference", tracked.inlier_fraction);
  } else if (tracked.pixel_error > config_.degraded_pixel_error) {
    tracked.status = TrackingStatus::kDegraded;
    tracked.reason = format("the image differs from the reference like one shifted by %.1f px", tracked.pixel_error);
  } else if (tracked.expected_error > config_.degraded_expected_error) {
    tracked.status = TrackingStatus::kDegraded;
    tracked.reason = format("the pose is known to %.1f px only", tracked.expected_error);
  } else if (!reference.doubt.empty()) {
    tracked.status = TrackingStatus::kDegraded;
    tracked.reason = reference.doubt;
  }
}

}  // namespace mba_vo
