#include "status_reporter.h"

#include <cmath>
#include <limits>
#include <utility>

#include "mba_vo/ros/conversions.h"
#include "mba_vo/ros/status_conversion.h"

namespace mba_vo {

StatusReporter::StatusReporter(ros::NodeHandle& nh) : publisher_(nh.advertise<Status>("status", 100, true)) {
  status_.exposure_source = "unknown";
  status_.exposure = status_.exposure_ratio = status_.exposure_ratio_sigma = std::numeric_limits<double>::quiet_NaN();
  publishLocked("no image yet");
}

void StatusReporter::imageReceived(std::uint64_t missing_before) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++status_.frames_in;
  status_.frames_missing += missing_before;
}

void StatusReporter::imageShed(std::int64_t stamp_ns) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++status_.frames_shed;
  status_.header.stamp = toRosTime(stamp_ns);
  publishLocked("image shed: the tracker does not keep up with the camera");
}

void StatusReporter::imageRejected(std::int64_t stamp_ns, const std::string& reason) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++status_.frames_rejected;
  status_.header.stamp = toRosTime(stamp_ns);
  rejection_ = "image rejected: " + reason;
  publishLocked(rejection_);
}

void StatusReporter::imageRepeated(std::int64_t stamp_ns, const std::string& reason) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++status_.frames_repeated;
  rejection_.clear();
  any_usable_ = true;
  status_.header.stamp = toRosTime(stamp_ns);
  publishLocked(reason);
}

void StatusReporter::imageTracked(const TrackedFrame& tracked, const std::string& exposure_source, bool tf_predicted) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::uint8_t previous = status_.state;
  status_.state = toState(tracked.publishedStatus());
  rejection_.clear();
  any_usable_ = true;
  status_.header.stamp = toRosTime(tracked.frame->stamp_ns);
  status_.reason = tracked.reason;
  status_.tf_predicted = tf_predicted;
  const PinholeCamera& camera = tracked.frame->pyramid.level(0).camera;
  status_.image_width = static_cast<std::uint32_t>(camera.width);
  status_.image_height = static_cast<std::uint32_t>(camera.height);
  status_.tracking_ms = tracked.tracking_ms;
  status_.exposure_source = exposure_source;
  status_.exposure = exposureToMessage(tracked.frame->exposure);
  const ExposureEstimate& estimate = tracked.exposure_estimate;
  const bool known = std::isfinite(estimate.log_sigma);
  status_.exposure_ratio = known ? estimate.ratio : std::numeric_limits<double>::quiet_NaN();
  status_.exposure_ratio_sigma = known ? estimate.log_sigma : std::numeric_limits<double>::quiet_NaN();
  switch (tracked.publishedStatus()) {
    case TrackingStatus::kTracking:
      ++status_.frames_tracked;
      break;
    case TrackingStatus::kDegraded:
      ++status_.frames_degraded;
      break;
    case TrackingStatus::kLost:
      ++status_.frames_lost;
      break;
    default:
      ++status_.frames_initializing;
  }
  if (!tracked.hasPose() || status_.state != previous) {
    publishLocked(status_.reason);
  }
}

void StatusReporter::trackerFailed(const std::string& what, bool on_image) {
  const std::lock_guard<std::mutex> lock(mutex_);
  status_.frames_failed += on_image ? 1 : 0;
  publishLocked("the tracker failed: " + what);
}

void StatusReporter::mapperSaid(const MapperStatus& mapper) {
  const std::lock_guard<std::mutex> lock(mutex_);
  status_.mapper = mapper;
}

void StatusReporter::referenceAdopted(const Reference& reference) {
  const std::lock_guard<std::mutex> lock(mutex_);
  status_.map_id = reference.id.map_id;
  status_.keyframe_id = reference.id.keyframe_id;
  status_.metric_scale = reference.metric;
}

void StatusReporter::referenceStale() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++status_.references_stale;
}

void StatusReporter::wasReset(const std::string& reason) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++status_.resets;
  rejection_.clear();
  status_.state = Status::WAITING;
  status_.map_id = 0;
  status_.keyframe_id = 0;
  status_.metric_scale = false;
  status_.tf_predicted = false;
  status_.reason = reason;
  publishLocked(status_.reason);
}

void StatusReporter::publish(const InputProblem& problem, std::size_t queue_bytes) {
  const std::lock_guard<std::mutex> lock(mutex_);
  status_.queue_bytes = queue_bytes;
  const bool usable = std::exchange(any_usable_, false);
  if (problem.silent || (!usable && !rejection_.empty())) status_.state = Status::WAITING;
  const std::string& own = rejection_.empty() ? status_.reason : rejection_;
  publishLocked(problem.text.empty() ? own : problem.text);
}

Status StatusReporter::snapshot() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return status_;
}

void StatusReporter::publishLocked(const std::string& reason) {
  Status message = status_;
  message.reason = reason;
  publisher_.publish(message);
}

}  // namespace mba_vo
