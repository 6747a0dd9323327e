#pragma once

#include <future>
#include <string>
#include <thread>
#include <vector>

#include "map_publisher.h"
#include "mapper_status_reporter.h"
#include "mba_vo/ros/bounded_queue.h"
#include "mba_vo/ros/intra_process_messages.h"

namespace mba_vo {

/// The mapper's own thread: takes tracked frames from a bounded queue, maps, publishes references and the map. All
/// public functions return at once and may be called from any thread.
class MapperWorker {
 public:
  MapperWorker(ros::NodeHandle& nh, const NodeConfig& config, MapperStatusReporter& status);
  ~MapperWorker();

  void addFrame(const TrackedFrameMessageConstPtr& frame);
  /// The trajectory after all frames added so far have been processed. Broken if the worker ends before.
  std::future<std::vector<TrajectoryEntry>> trajectory();
  std::size_t queueBytes() const { return queue_.bytes(); }

 private:
  struct Job {
    TrackedFrameMessageConstPtr frame;  // or, if null:
    std::shared_ptr<std::promise<std::vector<TrajectoryEntry>>> trajectory;
  };
  static std::size_t bytesOf(const Job& job);
  static std::size_t mostDispensable(const std::deque<Job>& jobs);

  void run();
  void process(const TrackedFrameMessage& message);
  void followSession(const TrackedFrameSummary& summary);
  void publishReference(const ReferenceConstPtr& reference, const TrackedFrameSummary& cause);

  const std::string map_frame_;
  MapperStatusReporter& status_;
  ros::Publisher references_;
  MapPublisher map_publisher_;
  BoundedQueue<Job> queue_;

  // Of the thread alone from here on.
  Mapper mapper_;
  const TrackedFrameSummary* cause_ = nullptr;  // of the frame being processed
  std::uint64_t session_ = 0;                   // of the newest frame; 0 = none yet
  MapId map_id_ = 0;                            // of the newest reference

  std::thread thread_;
};

}  // namespace mba_vo
