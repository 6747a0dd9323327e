#include "mapper_worker.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include <ros/ros.h>
#include <boost/make_shared.hpp>

#include "mba_vo/ros/conversions.h"
#include "node_constants.h"

namespace mba_vo {
MapperWorker::MapperWorker(ros::NodeHandle& nh, const NodeConfig& config, MapperStatusReporter& status)
    : map_frame_(config.frames.map_frame),
      status_(status),
      references_(nh.advertise<ReferenceMessage>("reference", 100)),
      map_publisher_(nh, config),
      pipeline_(config.odometry.mapper, static_cast<std::size_t>(kBytesPerMegabyte * config.mapper_queue_mb)),
      thread_({[this] { return step(); }, [this](const std::string& what) { recover(what); }},
              PipelineThread::Priority::kBackground) {}

void MapperWorker::addFrame(const TrackedFrameMessageConstPtr& frame) {
  for (std::size_t shed = pipeline_.addFrame(frame->message).size(); shed > 0; --shed) {
    ROS_WARN_THROTTLE(kWarnPeriod, "tracked frames are shed: the mapper does not keep up with the tracker");
    status_.frameShed();
  }
  thread_.wake();
}

void MapperWorker::beginIn(std::shared_ptr<const SavedMap> map) {
  pipeline_.beginIn(std::move(map));
  thread_.wake();
}

bool MapperWorker::step() {
  const ros::SteadyTime begin = ros::SteadyTime::now();
  const bool worked = work();
  if (worked) busy_seconds_ = busy_seconds_ + (ros::SteadyTime::now() - begin).toSec();
  return worked;
}

bool MapperWorker::work() {
  pipeline_.watchSharpKeyframes(map_publisher_.wantsSharpKeyframes());
  const std::optional<MapperStep> step = pipeline_.step();
  status_.inPhase(pipeline_.mapper().phase());
  if (step && step->isOfFrame()) {
    publish(*step);
  } else if (step && step->reference.reference) {
    publishReference(step->reference);
  }
  return step.has_value();
}

void MapperWorker::recover(const std::string& what) {
  ROS_ERROR_STREAM("the mapper failed, a new map begins: " << what);
  status_.failed(what);
  const MapperMessage closed = pipeline_.recover("the mapper failed: " + what);
  status_.inPhase(pipeline_.mapper().phase());
  if (closed.reference) publishReference(closed);
  status_.publish(pipeline_.queueBytes());
}

void MapperWorker::publish(const MapperStep& step) {
  const MapperOutput& output = step.output;
  const ros::Time stamp = toRosTime(step.cause.tracked->frame->stamp_ns);
  const std::string& camera_frame = step.cause.mount.camera_frame;
  if (step.was_reset) status_.wasReset("reset by the tracker");
  if (step.kind == MapperStep::Kind::kFrame) status_.frameProcessed(*step.cause.tracked, step.stale);
  status_.mapped(output);
  status_.keyframesDeblurred(pipeline_.mapper().deblurCounts());
  if (output.reference) publishReference(step.reference);
  if (output.keyframe || output.reference || output.is_news || step.was_reset) {
    ROS_INFO_STREAM_COND(!output.message.empty(), output.message);
    status_.publish(pipeline_.queueBytes());
  }
  if (output.reference && !output.inserted) map_publisher_.publishKeyframe(*output.reference, camera_frame, stamp);
  if (output.sharp_keyframe) map_publisher_.publishSharpKeyframe(*output.sharp_keyframe, camera_frame);
  if (step.kind == MapperStep::Kind::kFrame || output.keyframe) {
    map_publisher_.publish(pipeline_.mapper(), step.cause.mount.T_base_camera, stamp);
  }
}

void MapperWorker::publishReference(const MapperMessage& message) {
  const auto out = boost::make_shared<ReferenceMessage>();
  out->summary = summarize(*message.reference, map_frame_);
  // A keyframe of an earlier run has no time in this one.
  out->summary.header.stamp = toRosTime(std::max<std::int64_t>(message.reference->mid_exposure_ns, 0));
  out->summary.session = message.session;
  out->summary.status = status_.snapshot();
  out->reference = message.reference;
  references_.publish(ReferenceMessageConstPtr(out));
}

}  // namespace mba_vo
