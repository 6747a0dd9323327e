#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <mba_vo/ExposureMotion.h>
#include <mba_vo/MapperStatus.h>
#include <mba_vo/Status.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <nodelet/loader.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_srvs/Trigger.h>
#include <tf2_msgs/TFMessage.h>

#include "mba_vo/ros/intra_process_messages.h"

namespace mba_vo {

/// Everything that came out so far.
struct Outputs {
  std::vector<nav_msgs::OdometryConstPtr> odometry;
  std::vector<geometry_msgs::PoseWithCovarianceStampedConstPtr> pose;
  std::vector<ExposureMotionConstPtr> exposure_motion;
  std::vector<StatusConstPtr> status;
  std::vector<MapperStatusConstPtr> mapper_status;
  std::vector<nav_msgs::PathConstPtr> path;
  std::vector<sensor_msgs::PointCloud2ConstPtr> points;
  std::vector<sensor_msgs::ImageConstPtr> keyframe_image;
  std::vector<sensor_msgs::ImageConstPtr> keyframe_sharp;
  std::vector<TrackedFrameMessageConstPtr> tracked_frame;
  std::vector<ReferenceMessageConstPtr> reference;
  std::vector<geometry_msgs::TransformStamped> transforms;
};

/// Both nodelets in this process, and ears on all their topics.
class LiveOdometry {
 public:
  /// `input`: namespace of the camera's topics. `manager`: that other nodelets are in, too; null = one of its own.
  LiveOdometry(const std::string& ns, const std::string& input, std::shared_ptr<nodelet::Loader> manager = nullptr,
               bool with_mapper = true);
  ~LiveOdometry();
  LiveOdometry(const LiveOdometry&) = delete;
  LiveOdometry& operator=(const LiveOdometry&) = delete;

  /// Ends the nodelet `name`, "mapping" or "tracking", and loads it again.
  void restart(const std::string& name);

  Outputs outputs() const;
  /// Newest status; a default one if none came yet.
  Status status() const;
  /// Waits until `condition` holds for the outputs; false after `timeout` [s] of wall time.
  bool waitFor(const std::function<bool(const Outputs&)>& condition, double timeout) const;
  /// Waits until `images` images have come in and every one has been dealt with by tracker and mapper.
  bool waitUntilDone(std::uint64_t images, double timeout) const;
  bool reset();
  /// Asks for the trajectory; its folder is the parameter output_directory.
  bool saveTrajectory() { return askForTrajectory().success != 0; }
  std_srvs::TriggerResponse askForTrajectory();

 private:
  void load(const std::string& name);
  template <typename Message>
  void listen(const std::string& topic, std::vector<boost::shared_ptr<const Message>> Outputs::*list);

  ros::NodeHandle nh_;
  ros::M_string remappings_;
  std::shared_ptr<nodelet::Loader> manager_;
  mutable std::mutex mutex_;
  Outputs outputs_;
  std::vector<ros::Subscriber> subscribers_;
};

/// Images that were dealt with, by the counters of a status.
std::uint64_t finishedImages(const Status& status);

/// Plays a bag as a separate process, with its clock; false if that fails.
bool playBag(const std::string& file, double rate);

}  // namespace mba_vo
