#include "mba_vo/io/run_log.h"

#include <algorithm>
#include <map>
#include <set>

namespace mba_vo {
namespace {

constexpr std::string_view kRepeated = "REPEATED";

void appendText(std::string& text, const std::string& more) {
  if (!more.empty()) {
    text += (text.empty() ? "" : "; ") + more;
  }
}

std::string_view statusWithoutResult(TrackerStep::Kind kind) {
  if (kind == TrackerStep::Kind::kRepeated) return kRepeated;
  return kind == TrackerStep::Kind::kShed ? "SHED" : "REJECTED";
}

void takeTracking(const TrackedFrame& tracked, FrameRecord& record) {
  record.status = toString(tracked.status);
  record.exposure = tracked.frame->exposure;
  record.reason = tracked.reason;
  if (tracked.tracked()) {
    record.blur_length_px = static_cast<float>(tracked.measures.blur_length_px);
    record.points_used = tracked.points_used;
    record.residual_rms = static_cast<float>(tracked.residual_rms);
    record.pixel_error = static_cast<float>(tracked.pixel_error);
  }
  record.tracking_ms += static_cast<float>(tracked.tracking_ms);
}

void takePublished(const PublishedImage& image, FrameRecord& record) {
  const TrackedFrame& tracked = *image.step.message.tracked;
  record.online_status = tracked.orientation_only ? "ORIENTATION" : toString(tracked.publishedStatus());
  if (!tracked.hasPose() && !tracked.orientation_only) return;
  record.published = image.published;
  if (!tracked.hasPose()) return;
  const SE3& T_odom_camera = image.step.T_odom_camera;
  const BodyMotion& motion = image.step.motion;
  const SE3 T_map_camera = image.step.T_map_odom * T_odom_camera;
  const double exposure = tracked.trajectory.exposure;
  record.online = {tracked.reference.map_id,
                   {T_map_camera, motion.velocity, exposure, motion.acceleration},
                   T_odom_camera,
                   image.step.covariance.odom,
                   image.step.covariance.velocity};
}

}  // namespace

void RunLog::add(const OdometryResult& result) {
  for (const PublishedImage& image : result.images) frames_.push_back(recordOf(image));
  if (frames_.empty()) return;
  frames_.back().mapping_ms += static_cast<float>(result.mapping_ms);
  for (const MapperOutput& mapping : result.mapping) {
    appendText(frames_.back().message, mapping.message);
    if (mapping.keyframe) keyframes_.push_back(*mapping.keyframe);
    if (mapping.reference && mapping.reference->metric) metric_maps_.insert(mapping.reference->id.map_id);
  }
  for (const TrackedFrameConstPtr& late : result.late) {
    addLate(*late);
  }
}

FrameRecord recordOf(const PublishedImage& image) {
  const TrackerStep& step = image.step;
  FrameRecord record;
  record.sequence = step.sequence;
  record.stamp_ns = step.stamp_ns;
  record.mid_exposure_ns = step.mid_exposure_ns;
  record.arrival = step.arrival;
  record.exposure = step.exposure;
  if (const TrackedFrameConstPtr& tracked = step.message.tracked) {
    takeTracking(*tracked, record);
    takePublished(image, record);
  } else {
    record.status = record.online_status = statusWithoutResult(step.kind);
  }
  appendText(record.reason, step.reason);
  return record;
}

void RunLog::addLate(const TrackedFrame& late) {
  const auto found = std::find_if(frames_.rbegin(), frames_.rend(),
                                  [&](const FrameRecord& record) { return record.sequence == late.frame->sequence; });
  if (found == frames_.rend()) return;
  const bool had_pose = found->points_used.has_value();
  if (had_pose && !late.tracked()) {
    found->tracking_ms += static_cast<float>(late.tracking_ms);  // in vain
    return;
  }
  takeTracking(late, *found);
  if (!had_pose) appendText(found->reason, "had to wait for a reference");
}

void RunLog::settle(const std::vector<TrajectoryEntry>& trajectory) {
  // What was shed was known before the images that waited had their results.
  const auto isEarlier = [](const FrameRecord& a, const FrameRecord& b) { return a.sequence < b.sequence; };
  std::stable_sort(frames_.begin(), frames_.end(), isEarlier);
  std::map<std::uint64_t, const TrajectoryEntry*> entry_of_frame;
  for (const TrajectoryEntry& entry : trajectory) {
    entry_of_frame[entry.frame_sequence] = &entry;
  }
  for (FrameRecord& frame : frames_) {
    const auto found = entry_of_frame.find(frame.sequence);
    const bool was_tracked = frame.points_used.has_value();
    if (found != entry_of_frame.end()) {
      const TrajectoryEntry& entry = *found->second;
      frame.map = entry.map_id;
      frame.metric = metric_maps_.count(entry.map_id) > 0;
      if (!was_tracked) {
        const bool initializing = frame.status == toString(TrackingStatus::kInitializing);
        frame.reason = initializing ? "tracked backwards after initialisation" : "tracked later by the mapper";
        frame.status = toString(entry.degraded ? TrackingStatus::kDegraded : TrackingStatus::kTracking);
      }
    } else if (was_tracked) {
      appendText(frame.reason, "pose given up by the mapper, was " + std::string(frame.status));
      frame.status = toString(TrackingStatus::kLost);
    }
  }
}

FrameCounts countFrames(const std::vector<FrameRecord>& frames) {
  const auto hasPose = [](const FrameRecord& frame) { return frame.hasPose(); };
  const auto isDropped = [](const FrameRecord& frame) { return !frame.hasPose() && frame.status != kRepeated; };
  const auto first = std::find_if(frames.begin(), frames.end(), hasPose);
  std::set<MapId> maps, metric_maps;
  FrameCounts counts;
  counts.frames = frames.size();
  for (const FrameRecord& frame : frames) {
    counts.rejected += frame.status == "REJECTED" ? 1U : 0U;
    counts.repeated += frame.status == kRepeated ? 1U : 0U;
    if (frame.hasPose()) {
      ++counts.tracked;
      maps.insert(*frame.map);
      if (frame.metric) metric_maps.insert(*frame.map);
    }
  }
  counts.dropped = counts.frames - counts.tracked - counts.repeated;
  counts.dropped_after_initialization = static_cast<std::size_t>(std::count_if(first, frames.end(), isDropped));
  counts.maps = maps.size();
  counts.metric_maps = metric_maps.size();
  return counts;
}

}  // namespace mba_vo
