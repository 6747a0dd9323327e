#include "mapper_worker.h"

#include <utility>

#include <ros/ros.h>
#include <boost/make_shared.hpp>

#include "thread_priority.h"

namespace mba_vo {
namespace {

constexpr double kBytesPerMegabyte = 1e6;
constexpr double kWarnPeriod = 5.0;  // [s]

/// A frame that no map depends on: it refines depths and has a row in the trajectory, but others do so too.
bool ordinary(const TrackedFrame& tracked) { return tracked.tracked() && !tracked.keyframe_requested; }

}  // namespace

std::size_t MapperWorker::bytesOf(const Job& job) {
  if (!job.frame) return 0;
  const Frame& frame = *job.frame->tracked->frame;
  return frame.pyramid.bytes() + frame.depth.total() * sizeof(float);
}

/// The oldest ordinary frame, or else the oldest frame.
std::size_t MapperWorker::mostDispensable(const std::deque<Job>& jobs) {
  std::size_t oldest = jobs.size();
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (!jobs[i].frame) {
      continue;
    }
    if (ordinary(*jobs[i].frame->tracked)) {
      return i;
    }
    oldest = std::min(oldest, i);
  }
  return oldest;
}

MapperWorker::MapperWorker(ros::NodeHandle& nh, const NodeConfig& config, MapperStatusReporter& status)
    : map_frame_(config.frames.map_frame),
      status_(status),
      references_(nh.advertise<ReferenceMessage>("reference", 100)),
      map_publisher_(nh, config),
      queue_(static_cast<std::size_t>(kBytesPerMegabyte * config.mapper_queue_mb), bytesOf, mostDispensable),
      mapper_(config.odometry.mapper, [this](const ReferenceConstPtr& draft) { publishReference(draft, *cause_); }),
      thread_([this] { run(); }) {}

MapperWorker::~MapperWorker() {
  queue_.stop();
  thread_.join();
}

void MapperWorker::addFrame(const TrackedFrameMessageConstPtr& frame) {
  const std::size_t shed = queue_.push({frame, nullptr}).size();
  for (std::size_t i = 0; i < shed; ++i) {
    ROS_WARN_THROTTLE(kWarnPeriod, "tracked frames are shed: the mapper does not keep up with the tracker");
    status_.frameShed();
  }
}

std::future<std::vector<TrajectoryEntry>> MapperWorker::trajectory() {
  auto promise = std::make_shared<std::promise<std::vector<TrajectoryEntry>>>();
  std::future<std::vector<TrajectoryEntry>> future = promise->get_future();
  queue_.push({nullptr, std::move(promise)});
  return future;
}

void MapperWorker::run() {
  const BackgroundThreads lower_priority;
  while (const std::optional<Job> job = queue_.pop()) {
    if (job->frame) {
      process(*job->frame);
      while (queue_.empty() && mapper_.doDeferredWork()) {
      }
    } else {
      mapper_.finishDeferredWork();
      job->trajectory->set_value(mapper_.trajectory());
    }
  }
}

void MapperWorker::process(const TrackedFrameMessage& message) {
  followSession(message.summary);
  const TrackedFrame& tracked = *message.tracked;
  const bool stale = tracked.tracked() && tracked.reference.map_id != map_id_;
  cause_ = &message.summary;
  const MapperOutput output = mapper_.process(message.tracked);
  status_.frameProcessed(tracked, output, stale);
  status_.keyframesDeblurred(mapper_.deblurCounts());
  if (output.reference) {
    publishReference(output.reference, message.summary);
  }
  if (output.keyframe || output.reference) {
    ROS_INFO_STREAM_COND(!output.message.empty(), output.message);
    status_.publish(queue_.bytes());
  }
  if (output.reference) {
    map_publisher_.publishKeyframe(*output.reference, message.summary.header.frame_id, message.summary.header.stamp);
  }
  if (output.sharp_keyframe) {
    map_publisher_.publishSharpKeyframe(*output.sharp_keyframe, message.summary.header.frame_id);
  }
  map_publisher_.publish(mapper_, message.T_base_camera, message.summary.header.stamp);
}

void MapperWorker::followSession(const TrackedFrameSummary& summary) {
  if (summary.session == session_) {
    return;
  }
  // A tracker that was merely restarted is given the current reference; one that was reset wants a new map.
  if (std::exchange(session_, summary.session) != 0 && !summary.keep_map) {
    mapper_.reset();
    map_id_ = 0;
    status_.keyframesDeblurred(mapper_.deblurCounts());
    status_.wasReset("reset by the tracker");
    status_.publish(queue_.bytes());
  }
}

void MapperWorker::publishReference(const ReferenceConstPtr& reference, const TrackedFrameSummary& cause) {
  const auto message = boost::make_shared<ReferenceMessage>();
  message->summary = summarize(*reference, map_frame_);
  message->summary.header.stamp = cause.header.stamp;
  message->summary.session = session_;
  message->summary.status = status_.snapshot();
  message->reference = reference;
  map_id_ = reference->id.map_id;
  references_.publish(ReferenceMessageConstPtr(message));
}

}  // namespace mba_vo
