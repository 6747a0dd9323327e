#include <filesystem>
#include <memory>

#include <nodelet/nodelet.h>
#include <std_srvs/Trigger.h>
#include <pluginlib/class_list_macros.hpp>

#include "mapper_worker.h"
#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {
namespace {

constexpr int kFrameQueue = 1000;      // callbacks only move the frame on, into the queue that is bounded in bytes
constexpr double kStatusPeriod = 1.0;  // [s]
constexpr double kWarnPeriod = 5.0;    // [s]
constexpr std::chrono::seconds kSaveTimeout(60);

}  // namespace

/// The mapper's doors to ROS. Callbacks only hand things on to the worker.
class MapperNodelet final : public nodelet::Nodelet {
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
    status_ = std::make_unique<MapperStatusReporter>(nh);
    worker_ = std::make_unique<MapperWorker>(nh, config, *status_);
    frame_subscriber_ = nh.subscribe("tracked_frame", kFrameQueue, &MapperNodelet::onFrame, this);
    // On another queue: it waits for the worker, and frames must go on arriving meanwhile.
    save_server_ = getMTNodeHandle().advertiseService("save_trajectory", &MapperNodelet::onSave, this);
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
    try {
      auto future = worker_->trajectory();
      if (future.wait_for(kSaveTimeout) != std::future_status::ready) {
        throw std::runtime_error("the mapper is still busy after " + std::to_string(kSaveTimeout.count()) + " s");
      }
      response.message = save(future.get());
      response.success = true;
      NODELET_INFO_STREAM(response.message);
    } catch (const std::exception& error) {
      response.message = error.what();
      response.success = false;
      NODELET_ERROR_STREAM("save_trajectory: " << error.what());
    }
    return true;
  }

  std::string save(const std::vector<TrajectoryEntry>& trajectory) const {
    if (trajectory.empty()) throw std::runtime_error("there is no pose to save: no image has been tracked yet");
    const std::filesystem::path folder = std::filesystem::absolute(output_directory_);
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
      throw std::runtime_error("folder '" + folder.string() + "' cannot be made: " + error.message());
    }
    writeFile((folder / "trajectory.txt").string(), [&](std::ostream& out) { writeTrajectory(trajectory, out); });
    writeFile((folder / "exposure_trajectory.txt").string(),
              [&](std::ostream& out) { writeExposureTrajectory(trajectory, out); });
    return std::to_string(trajectory.size()) + " poses written to " + folder.string();
  }

  void onStatusTimer(const ros::SteadyTimerEvent& /*event*/) {
    alone_ = frame_subscriber_.getNumPublishers() == 0 ? alone_ + kStatusPeriod : 0.0;
    if (alone_ > kWarnPeriod) {
      NODELET_WARN_STREAM_THROTTLE(kWarnPeriod, "there is no tracker: nobody publishes "
                                                    << frame_subscriber_.getTopic()
                                                    << "; load mba_vo/Tracker into the manager of the mapper");
    }
    status_->publish(worker_->queueBytes());
  }

  std::string output_directory_;
  double alone_ = 0.0;  // for how long there has been no tracker [s]
  std::unique_ptr<MapperStatusReporter> status_;
  std::unique_ptr<MapperWorker> worker_;
  ros::Subscriber frame_subscriber_;
  ros::ServiceServer save_server_;
  ros::SteadyTimer status_timer_;
};

}  // namespace mba_vo

PLUGINLIB_EXPORT_CLASS(mba_vo::MapperNodelet, nodelet::Nodelet)
