#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <utility>

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
  /// MapperPipeline::ask.
  template <typename Question>
  auto ask(Question question) {
    auto answer = pipeline_.ask(std::move(question));
    thread_.wake();
    return answer;
  }
  /// MapperPipeline::beginIn.
  void beginIn(std::shared_ptr<const SavedMap> map);
  std::size_t queueBytes() const { return pipeline_.queueBytes(); }
  /// How long it has worked since the start [s].
  double busySeconds() const { return busy_seconds_; }

 private:
  bool step();
  bool work();
  void recover(const std::string& what);
  void publish(const MapperStep& step);
  void publishReference(const MapperMessage& message);

  const std::string map_frame_;
  MapperStatusReporter& status_;
  ros::Publisher references_;
  MapPublisher map_publisher_;
  MapperPipeline pipeline_;
  std::atomic<double> busy_seconds_{0.0};
  PipelineThread thread_;  // the last one: it ends first
};

}  // namespace mba_vo
