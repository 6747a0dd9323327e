#include "mapper_status_reporter.h"

#include "mba_vo/ros/conversions.h"

namespace mba_vo {

MapperStatusReporter::MapperStatusReporter(ros::NodeHandle& nh)
    : publisher_(nh.advertise<MapperStatus>("mapper/status", 10, true)) {
  status_.phase = toString(MappingPhase::kInitializing);
  status_.message = "no frame yet";
  publisher_.publish(status_);
}

void MapperStatusReporter::frameReceived(const TrackedFrameSummary& summary) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++status_.frames_in;
  if (summary.session != session_) {  // the first message seen of a tracker may be any
    session_ = summary.session;
    next_number_ = summary.number;
  }
  if (summary.number > next_number_) {
    status_.frames_missing += summary.number - next_number_;
  }
  next_number_ = summary.number + 1;
}

void MapperStatusReporter::frameShed() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++status_.frames_shed;
}

void MapperStatusReporter::frameUnusable(const std::string& reason) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++status_.frames_unusable;
  status_.message = reason;
}

void MapperStatusReporter::frameProcessed(const TrackedFrame& frame, bool stale) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++status_.frames_processed;
  status_.frames_stale += stale ? 1 : 0;
  status_.header.stamp = toRosTime(frame.frame->stamp_ns);
}

void MapperStatusReporter::inPhase(MappingPhase phase) {
  const std::lock_guard<std::mutex> lock(mutex_);
  status_.phase = toString(phase);
}

void MapperStatusReporter::mapped(const MapperOutput& output) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!output.message.empty()) {
    status_.message = output.message;
  }
  if (output.reference) {
    status_.map_id = output.reference->id.map_id;
    status_.keyframe_id = output.reference->id.keyframe_id;
  }
  if (output.keyframe) {
    ++status_.keyframes;
    status_.keyframe_ms = output.keyframe->total_ms;
  }
}

void MapperStatusReporter::keyframesDeblurred(const DeblurCounts& counts) {
  const std::lock_guard<std::mutex> lock(mutex_);
  status_.deblur_offered = counts.offered;
  status_.deblur_waiting = counts.waiting;
  status_.deblur_sharpened = counts.sharpened;
  status_.deblur_in_map = counts.in_map;
  status_.deblur_unsuited = counts.unsuited;
  status_.deblur_reason = counts.unsuited_reason;
  status_.deblur_passed_over = counts.passed_over;
  status_.deblur_too_slow = counts.too_slow;
  status_.deblur_forgotten = counts.forgotten;
}

void MapperStatusReporter::failed(const std::string& what) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++status_.frames_unusable;
  status_.map_id = 0;
  status_.keyframe_id = 0;
  status_.message = "the mapper failed: " + what;
}

void MapperStatusReporter::wasReset(const std::string& reason) {
  const std::lock_guard<std::mutex> lock(mutex_);
  status_.map_id = 0;
  status_.keyframe_id = 0;
  status_.message = reason;
}

void MapperStatusReporter::publish(std::size_t queue_bytes) {
  const std::lock_guard<std::mutex> lock(mutex_);
  status_.queue_bytes = queue_bytes;
  publisher_.publish(status_);
}

MapperStatus MapperStatusReporter::snapshot() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return status_;
}

}  // namespace mba_vo
