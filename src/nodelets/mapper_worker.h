#pragma once

#include <atomic>
#include <future>
#include <mutex>
#include <string>
#include <vector>

#include "map_publisher.h"
#include "mapper_status_reporter.h"
#include "mba_vo/odometry/mapper_pipeline.h"
#include "mba_vo/odometry/pipeline_thread.h"
#include "mba_vo/ros/intra_process_messages.h"

namespace mba_vo {

/// The mapper half of the pipeline with a thread of its own, and what it has to say to ROS. All public functions return
/// at once and may be called from any thread.
class MapperWorker {
 public:
  MapperWorker(ros::NodeHandle& nh, const NodeConfig& config, MapperStatusReporter& status);

  void addFrame(const TrackedFrameMessageConstPtr& frame);
  /// The trajectory after all frames added so far have been processed. Broken if the worker ends before.
  std::future<std::vector<TrajectoryEntry>> trajectory();
  /// The points of the present map.
  std::future<std::vector<MapPoint>> points();
  std::size_t queueBytes() const { return pipeline_.queueBytes(); }
  /// How long it has worked since the start [s].
  double busySeconds() const { return busy_seconds_; }

 private:
  bool step();
  bool work();
  bool answerPoints();
  void recover(const std::string& what);
  void publish(const MapperStep& step);
  void publishReference(const MapperMessage& message);

  const std::string map_frame_;
  MapperStatusReporter& status_;
  ros::Publisher references_;
  MapPublisher map_publisher_;
  MapperPipeline pipeline_;
  std::atomic<double> busy_seconds_{0.0};
  std::mutex requests_mutex_;
  std::vector<std::promise<std::vector<MapPoint>>> points_requests_;
  PipelineThread thread_;  // the last one: it ends first
};

}  // namespace mba_vo
