#include "mba_vo/ros/diagnostics.h"

#include <algorithm>
#include <cstdint>
#include <sstream>

namespace mba_vo {
namespace {

using Diagnostic = diagnostic_updater::DiagnosticStatusWrapper;

constexpr double kLateImages = 5.0;  // that have come since; what waits for its exposure message is less
constexpr double kFullLoad = 0.95;   // share of the time
constexpr double kMilliseconds = 1e3;
constexpr double kMegabytes = 1e-6;

/// What has been counted since the last time; a node that was restarted counts anew.
template <typename Message>
std::uint64_t since(std::uint64_t Message::*counter, const Message& before, const Message& now) {
  return now.*counter >= before.*counter ? now.*counter - before.*counter : now.*counter;
}

double perSecond(std::uint64_t count, double seconds) {
  return seconds > 0.0 ? static_cast<double>(count) / seconds : 0.0;
}

void warn(const std::string& message, Diagnostic& diagnostic) {
  diagnostic.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, message);
}

void fail(const std::string& message, Diagnostic& diagnostic) {
  diagnostic.mergeSummary(diagnostic_msgs::DiagnosticStatus::ERROR, message);
}

std::string stateName(const Status& status) {
  switch (status.state) {
    case Status::TRACKING:
      return "tracking";
    case Status::DEGRADED:
      return "degraded";
    case Status::LOST:
      return "lost";
    case Status::INITIALIZING:
      return "initializing";
    default:
      return "waiting";
  }
}

std::string withReason(const std::string& what, const std::string& reason) {
  return reason.empty() ? what : what + ": " + reason;
}

void checkImages(const TrackerHealth& health, std::uint64_t images, Diagnostic& diagnostic) {
  const std::uint64_t rejected = since(&Status::frames_rejected, health.before, health.now);
  const std::uint64_t missing = since(&Status::frames_missing, health.before, health.now);
  if (!health.missing_input.empty()) {
    fail(health.missing_input, diagnostic);
  } else if (images > 0 && rejected >= images) {
    fail(withReason("every image is rejected", health.now.reason), diagnostic);
  } else if (rejected > 0) {
    warn(std::to_string(rejected) + " of " + std::to_string(images) + " images rejected", diagnostic);
  }
  if (missing > 0) warn(std::to_string(missing) + " images never arrived", diagnostic);
}

}  // namespace

std::string describe(const CameraCalibration& calibration) {
  std::ostringstream text;
  text << calibration.width << "x" << calibration.height << ", fx " << calibration.fx << ", fy " << calibration.fy
       << ", cx " << calibration.cx << ", cy " << calibration.cy << ", "
       << (isUndistorted(calibration) ? "no distortion" : calibration.distortion_model);
  return text.str();
}

void diagnoseInput(const TrackerHealth& health, Diagnostic& diagnostic) {
  const Status& now = health.now;
  const std::uint64_t images = since(&Status::frames_in, health.before, now);
  diagnostic.summary(diagnostic_msgs::DiagnosticStatus::OK, "images come");
  checkImages(health, images, diagnostic);
  if (now.exposure_source == "corrected") {
    diagnostic.mergeSummaryf(diagnostic_msgs::DiagnosticStatus::WARN,
                             "exposures that come are wrong, by the blur: times %.3g would be right",
                             now.exposure_ratio);
  }
  diagnostic.add("image rate [1/s]", perSecond(images, health.seconds));
  diagnostic.add("images", now.frames_in);
  diagnostic.add("images rejected", now.frames_rejected);
  diagnostic.add("images repeated", now.frames_repeated);
  diagnostic.add("images that never arrived", now.frames_missing);
  diagnostic.add("exposure source", now.exposure_source);
  diagnostic.add("exposure [ms]", kMilliseconds * now.exposure);
  diagnostic.add("exposure by blur over given", now.exposure_ratio);
  diagnostic.add("worked on at", std::to_string(now.image_width) + "x" + std::to_string(now.image_height));
  diagnostic.add("calibration", health.calibration.empty() ? "none yet" : health.calibration);
}

void diagnoseTracking(const TrackerHealth& health, Diagnostic& diagnostic) {
  const Status& now = health.now;
  diagnostic.summary(diagnostic_msgs::DiagnosticStatus::OK, "tracking");
  if (now.state == Status::LOST) {
    diagnostic.summary(diagnostic_msgs::DiagnosticStatus::ERROR, withReason("lost", now.reason));
  } else if (now.state != Status::TRACKING) {
    diagnostic.summary(diagnostic_msgs::DiagnosticStatus::WARN, withReason(stateName(now), now.reason));
  }
  const std::uint64_t failed = since(&Status::frames_failed, health.before, now);
  const std::uint64_t shed = since(&Status::frames_shed, health.before, now);
  const double rate = perSecond(since(&Status::frames_in, health.before, now), health.seconds);
  if (failed > 0) fail("the tracker failed on " + std::to_string(failed) + " images", diagnostic);
  if (shed > 0) warn(std::to_string(shed) + " images shed: the tracker does not keep up", diagnostic);
  if (health.latency * rate > kLateImages) {
    diagnostic.mergeSummaryf(diagnostic_msgs::DiagnosticStatus::WARN, "poses come %.2f s after their images",
                             health.latency);
  }
  diagnostic.add("state", stateName(now));
  diagnostic.add("latency [ms]", kMilliseconds * health.latency);
  diagnostic.add("tracking time [ms]", now.tracking_ms);
  diagnostic.add("images waiting [MB]", kMegabytes * static_cast<double>(now.queue_bytes));
  diagnostic.add("images tracked", now.frames_tracked);
  diagnostic.add("images degraded", now.frames_degraded);
  diagnostic.add("images lost", now.frames_lost);
  diagnostic.add("images shed", now.frames_shed);
  diagnostic.add("map", now.map_id);
  diagnostic.add("keyframe", now.keyframe_id);
  diagnostic.add("metric scale", static_cast<bool>(now.metric_scale));
}

void diagnoseMapping(const MapperHealth& health, Diagnostic& diagnostic) {
  const MapperStatus& now = health.now;
  const double load = health.seconds > 0.0 ? std::min(1.0, health.busy_seconds / health.seconds) : 0.0;
  diagnostic.summary(diagnostic_msgs::DiagnosticStatus::OK, now.map_id == 0 ? "no map yet" : "mapping");
  const std::uint64_t unusable = since(&MapperStatus::frames_unusable, health.before, now);
  const std::uint64_t shed = since(&MapperStatus::frames_shed, health.before, now);
  const std::uint64_t missing = since(&MapperStatus::frames_missing, health.before, now);
  if (unusable > 0) fail(withReason(std::to_string(unusable) + " frames of no use", now.message), diagnostic);
  if (shed > 0) warn(std::to_string(shed) + " frames shed: the mapper does not keep up", diagnostic);
  if (missing > 0) warn(std::to_string(missing) + " frames of the tracker never arrived", diagnostic);
  if (load > kFullLoad) warn("the mapper is busy all the time: keyframes come late", diagnostic);
  diagnostic.add("state", now.phase);
  diagnostic.addf("load", "%.0f %%", 100.0 * load);
  diagnostic.add("frames waiting [MB]", kMegabytes * static_cast<double>(now.queue_bytes));
  diagnostic.add("frames processed", now.frames_processed);
  diagnostic.add("frames shed", now.frames_shed);
  diagnostic.add("keyframes", now.keyframes);
  diagnostic.add("keyframe time [ms]", now.keyframe_ms);
  diagnostic.add("map", now.map_id);
  diagnostic.add("keyframes sharpened", now.deblur_sharpened);
  diagnostic.add("last message", now.message);
}

}  // namespace mba_vo
