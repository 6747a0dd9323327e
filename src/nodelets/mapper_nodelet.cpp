#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include <mba_vo/MapFile.h>
#include <nodelet/nodelet.h>
#include <std_srvs/Trigger.h>
#include <pluginlib/class_list_macros.hpp>

#include "diagnostics_publisher.h"
#include "map_saving.h"
#include "mapper_worker.h"
#include "node_constants.h"

namespace mba_vo {
namespace {

constexpr int kFrameQueue = 1000;  // callbacks only move the frame on, into the queue that is bounded in bytes
constexpr std::chrono::seconds kShutdownTimeout(10);  // roslaunch kills after 15 s

}  // namespace

/// The mapper's doors to ROS. Callbacks only hand things on to the worker.
class MapperNodelet final : public nodelet::Nodelet {
 public:
  /// No callback comes any more, and the worker still works.
  ~MapperNodelet() override {
    if (save_on_shutdown_ && worker_) saveAtTheEnd();
  }
  MapperNodelet() = default;
  MapperNodelet(const MapperNodelet&) = delete;
  MapperNodelet& operator=(const MapperNodelet&) = delete;

 private:
  void onInit() override {
    try {
      start(getNodeHandle());
    } catch (const std::exception& error) {
      NODELET_FATAL_STREAM(error.what());  // the loader would only say that it failed
      throw;
    }
  }

  void start(ros::NodeHandle& nh) {
    const NodeConfig config = parseNodeConfig(readParameters(nh));
    output_directory_ = config.output_directory;
    save_on_shutdown_ = config.save_on_shutdown;
    status_ = std::make_unique<MapperStatusReporter>(nh);
    diagnostics_ = std::make_unique<MapperDiagnostics>(nh, getPrivateNodeHandle(), getName());
    worker_ = std::make_unique<MapperWorker>(nh, config, *status_);
    if (!config.map_file.empty()) NODELET_INFO_STREAM(loadMap(output_directory_, config.map_file, *worker_));
    frame_subscriber_ = nh.subscribe("tracked_frame", kFrameQueue, &MapperNodelet::onFrame, this);
    // On another queue: they wait for the worker, and frames must go on arriving meanwhile.
    save_server_ = getMTNodeHandle().advertiseService("save_trajectory", &MapperNodelet::onSave, this);
    save_points_server_ = getMTNodeHandle().advertiseService("save_points", &MapperNodelet::onSavePoints, this);
    save_map_server_ = getMTNodeHandle().advertiseService("save_map", &MapperNodelet::onSaveMap, this);
    load_map_server_ = getMTNodeHandle().advertiseService("load_map", &MapperNodelet::onLoadMap, this);
    status_timer_ = nh.createSteadyTimer(ros::WallDuration(kStatusPeriod), &MapperNodelet::onStatusTimer, this);
  }

  void onFrame(const TrackedFrameMessageConstPtr& frame) {
    if (!frame->message.tracked) {
      const std::string reason = "a message on " + frame_subscriber_.getTopic() +
                                 " came from another process and carries no image: load tracker and mapper into one "
                                 "manager";
      NODELET_ERROR_STREAM_THROTTLE(kWarnPeriod, reason);
      status_->frameUnusable(reason);
      return;
    }
    status_->frameReceived(frame->summary);
    worker_->addFrame(frame);
  }

  bool onSave(std_srvs::Trigger::Request& /*request*/, std_srvs::Trigger::Response& response) {
    return answer("save_trajectory", response, [this] { return saveTrajectory(output_directory_, *worker_); });
  }

  bool onSavePoints(std_srvs::Trigger::Request& /*request*/, std_srvs::Trigger::Response& response) {
    return answer("save_points", response, [this] { return savePoints(output_directory_, *worker_); });
  }

  bool onSaveMap(MapFile::Request& request, MapFile::Response& response) {
    return answer("save_map", response, [&] { return saveMap(output_directory_, request.file, *worker_); });
  }

  bool onLoadMap(MapFile::Request& request, MapFile::Response& response) {
    return answer("load_map", response, [&] { return loadMap(output_directory_, request.file, *worker_); });
  }

  /// `work` says what it has done, or throws.
  template <typename Response>
  bool answer(const char* service, Response& response, const std::function<std::string()>& work) {
    const std::lock_guard<std::mutex> one_at_a_time(answer_mutex_);  // two may want the same file
    try {
      response.message = work();
      response.success = true;
      NODELET_INFO_STREAM(response.message);
    } catch (const std::exception& error) {
      response.message = error.what();
      response.success = false;
      NODELET_ERROR_STREAM(service << ": " << error.what());
    }
    return true;
  }

  void onStatusTimer(const ros::SteadyTimerEvent& /*event*/) {
    alone_ = frame_subscriber_.getNumPublishers() == 0 ? alone_ + kStatusPeriod : 0.0;
    if (alone_ > kWarnPeriod) {
      NODELET_WARN_STREAM_THROTTLE(kWarnPeriod, "there is no tracker: nobody publishes "
                                                    << frame_subscriber_.getTopic()
                                                    << "; load mba_vo/Tracker into the manager of the mapper");
    }
    status_->publish(worker_->queueBytes());
    diagnostics_->update(status_->snapshot(), worker_->busySeconds());
  }

  void saveAtTheEnd() const {
    try {
      NODELET_INFO_STREAM(saveTrajectory(output_directory_, *worker_, kShutdownTimeout));
    } catch (const std::exception& error) {
      NODELET_ERROR_STREAM("save_on_shutdown: " << error.what());
    }
  }

  std::mutex answer_mutex_;
  bool save_on_shutdown_ = false;
  std::string output_directory_;
  double alone_ = 0.0;  // for how long there has been no tracker [s]
  std::unique_ptr<MapperStatusReporter> status_;
  std::unique_ptr<MapperWorker> worker_;
  std::unique_ptr<MapperDiagnostics> diagnostics_;
  ros::Subscriber frame_subscriber_;
  ros::ServiceServer save_server_;
  ros::ServiceServer save_points_server_;
  ros::ServiceServer save_map_server_;
  ros::ServiceServer load_map_server_;
  ros::SteadyTimer status_timer_;
};

}  // namespace mba_vo

PLUGINLIB_EXPORT_CLASS(mba_vo::MapperNodelet, nodelet::Nodelet)
