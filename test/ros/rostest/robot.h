#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "demo_sequence.h"
#include "live_odometry.h"
#include "mba_vo/ros/bag_reader.h"
#include "sequence_camera.h"

namespace mba_vo {

constexpr double kTimeout = 60.0;  // [s]
constexpr double kPatience = 3.0;  // [s] until an image counts as lost, to a nodelet that was not connected yet

struct Recording {
  DemoSequence sequence;
  std::vector<CameraImage> images;
  CameraCalibration calibration;
};

inline const Recording& recording() {
  static const Recording once = [] {
    std::string folder;
    if (!ros::param::get("/demo_folder", folder)) throw std::runtime_error("parameter /demo_folder is missing");
    Recording made{makeDemoSequence(folder), {}, {}};
    const auto reader = openBag(made.sequence.bag, {});
    made.calibration = reader->calibration();
    while (auto image = reader->next()) made.images.push_back(*image);
    return made;
  }();
  return once;
}

/// A camera and the nodelets, in namespaces of their own.
class Robot {
 public:
  explicit Robot(const std::string& name, const std::shared_ptr<nodelet::Loader>& manager = nullptr,
                 const std::string& transport = "raw", double extrinsic_wait = 0.0)
      : folder_((std::filesystem::temp_directory_path() / ("mba_vo_lifecycle_" + name)).string()) {
    std::filesystem::remove_all(folder_);
    ros::NodeHandle parameters("/" + name);
    parameters.setParam("extrinsic_wait", extrinsic_wait);
    parameters.setParam("path_period", 0.0);
    parameters.setParam("image_transport", transport);
    parameters.setParam("output_directory", folder_);
    for (const char* frame : {"map", "odom", "base", "exposure_start", "exposure_end"}) {
      parameters.setParam(std::string(frame) + "_frame", name + "_" + frame);
    }
    odometry = std::make_unique<LiveOdometry>("/" + name, "/" + name + "_camera", manager);
    const boost::function<void(const TrackedFrameMessageConstPtr&)> on_frame = [this](const auto& message) {
      const std::lock_guard<std::mutex> lock(mutex_);
      const TrackedFrame& frame = *message->message.tracked;
      tracked_.insert(frame.frame->sequence);
      const bool waits = message->message.has_reference && frame.status == TrackingStatus::kInitializing;
      if (waits) waiting_.insert(frame.frame->sequence);
      if (!waits) waiting_.erase(frame.frame->sequence);
      to_map_.insert(message->summary.header.stamp);
      changed_.notify_all();
    };
    const boost::function<void(const nav_msgs::PathConstPtr&)> on_path = [this](const auto& path) {
      const std::lock_guard<std::mutex> lock(mutex_);
      // One comes for every frame, and another for a keyframe that has been refined.
      const auto mapped = to_map_.find(path->header.stamp);
      if (mapped != to_map_.end()) to_map_.erase(mapped);
      changed_.notify_all();
    };
    subscribers_ = {parameters.subscribe<TrackedFrameMessage>("tracked_frame", 1000, on_frame),
                    parameters.subscribe<nav_msgs::Path>("path", 1000, on_path)};
    camera = std::make_unique<SequenceCamera>("/" + name + "_camera", recording().images, recording().calibration,
                                              transport);
  }
  ~Robot() {
    odometry.reset();
    std::filesystem::remove_all(folder_);
  }
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  /// Sends images [first, end), each when tracker and mapper have dealt with the one before, however slow the machine
  /// is.
  void see(std::size_t first, std::size_t end, bool covered = false) {
    ASSERT_TRUE(camera->waitForReaders(kTimeout));
    for (std::size_t i = first; i < end; ++i) {
      camera->send(i, covered);
      std::unique_lock<std::mutex> lock(mutex_);
      ++sent_;
      const auto idle = [this] { return tracked_.size() >= sent_ && waiting_.empty() && to_map_.empty(); };
      if (changed_.wait_for(lock, std::chrono::duration<double>(kPatience), idle)) continue;
      sent_ = tracked_.size();
      waiting_.clear();
      to_map_.clear();
    }
  }

  /// With the newest image: a second after it, on a busy machine before anybody looks, the tracker waits for another.
  testing::AssertionResult becomesTracking() const {
    const auto is_tracking = [](const Outputs& o) {
      const auto newest = std::find_if(o.status.rbegin(), o.status.rend(),
                                       [](const auto& status) { return status->state != Status::WAITING; });
      return newest != o.status.rend() && (*newest)->state == Status::TRACKING;
    };
    if (odometry->waitFor(is_tracking, kTimeout)) return testing::AssertionSuccess();
    const Outputs outputs = odometry->outputs();
    return testing::AssertionFailure() << *outputs.status.back() << *outputs.mapper_status.back();
  }
  bool isDone(std::uint64_t images) const { return odometry->waitUntilDone(images, kTimeout); }

  std::string file(const std::string& name) const { return folder_ + "/" + name; }

  std::unique_ptr<LiveOdometry> odometry;
  std::unique_ptr<SequenceCamera> camera;

 private:
  std::string folder_;
  std::vector<ros::Subscriber> subscribers_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::uint64_t> tracked_;  // numbers of images
  std::set<std::uint64_t> waiting_;  // likewise, of those that the tracker has still to catch up with
  std::multiset<ros::Time> to_map_;  // stamps of the frames that the mapper has not dealt with yet
  std::size_t sent_ = 0;             // images
};

}  // namespace mba_vo
