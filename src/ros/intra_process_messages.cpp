#include "mba_vo/ros/intra_process_messages.h"

#include "mba_vo/ros/conversions.h"
#include "mba_vo/ros/status_conversion.h"

namespace mba_vo {

TrackedFrameSummary summarize(const TrackerMessage& message) {
  const TrackedFrame& tracked = *message.tracked;
  TrackedFrameSummary summary;
  summary.session = message.session;
  summary.keep_map = message.keep_map;
  summary.header.stamp = toRosTime(tracked.frame->stamp_ns);
  summary.header.frame_id = message.mount.camera_frame;
  summary.sequence = tracked.frame->sequence;
  summary.mid_time = toRosTime(tracked.frame->mid_exposure_ns);
  summary.exposure_time = exposureToMessage(tracked.frame->exposure);
  summary.has_reference = message.has_reference;
  summary.state = toState(tracked.status);
  summary.reason = tracked.reason;
  summary.map_id = tracked.reference.map_id;
  summary.keyframe_id = tracked.reference.keyframe_id;
  summary.revision = tracked.reference.revision;
  summary.pose = toPoseMsg(tracked.trajectory.T_reference_mid);
  summary.linear_velocity = toVector3Msg(tracked.trajectory.velocity.head<3>());
  summary.angular_velocity = toVector3Msg(tracked.trajectory.velocity.tail<3>());
  summary.blur_length = tracked.measures.blur_length_px;
  summary.residual_rms = tracked.residual_rms;
  summary.points_used = static_cast<std::uint32_t>(tracked.points_used);
  summary.keyframe_requested = tracked.keyframe_requested;
  return summary;
}

ReferenceSummary summarize(const Reference& reference, const std::string& map_frame) {
  ReferenceSummary summary;
  summary.header.frame_id = map_frame;
  summary.map_id = reference.id.map_id;
  summary.keyframe_id = reference.id.keyframe_id;
  summary.revision = reference.id.revision;
  summary.cause = toString(reference.cause);
  summary.pose = toPoseMsg(reference.T_corrected_map * reference.T_map_reference);
  summary.points = static_cast<std::uint32_t>(reference.points.size());
  for (const auto& keyframe : reference.T_map_keyframe) {
    summary.window.push_back(keyframe.first);
  }
  summary.has_hint = reference.hint.has_value();
  return summary;
}

}  // namespace mba_vo
