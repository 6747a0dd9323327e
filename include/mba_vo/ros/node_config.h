#pragma once

#include <optional>
#include <string>

#include <ros/node_handle.h>
#include <yaml-cpp/yaml.h>

#include "mba_vo/odometry/config.h"
#include "mba_vo/ros/conversions.h"

namespace mba_vo {

struct FrameNames {
  std::string map_frame = "map";
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
  std::string exposure_start_frame = "exposure_start";
  std::string exposure_end_frame = "exposure_end";
};

/// All parameters of the two nodelets: those of ROS and, in sub-namespaces, those of the odometry itself.
struct NodeConfig {
  FrameNames frames;
  bool publish_tf = true;
  double tf_prediction = 0.0;
  double extrinsic_wait = 0.5;
  std::string stamp_reference = "middle";
  std::string exposure_time = "auto";
  double exposure_wait = 0.1;
  double calibration_wait = 1.0;
  double depth_wait = 0.05;
  double depth_tolerance = 0.02;
  std::string depth_transport = "raw";
  std::string image_transport = "raw";
  bool rectified = false;
  double no_image_warning = 1.0;
  double image_queue_mb = 64.0;
  double mapper_queue_mb = 512.0;
  double path_period = 0.5;
  double points_period = 1.0;
  bool record = true;
  bool save_on_shutdown = false;
  std::string map_file;
  std::string output_directory = "mba_vo_output";
  OdometryConfig odometry;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("map_frame", c.frames.map_frame, "frame of pose, path and points");
    v("odom_frame", c.frames.odom_frame, "frame of odometry and exposure_motion; continuous");
    v("base_frame", c.frames.base_frame, "moving frame; its transform to the image's frame is taken from TF");
    v("exposure_start_frame", c.frames.exposure_start_frame, "camera when the shutter opened, optical axes");
    v("exposure_end_frame", c.frames.exposure_end_frame, "camera when the shutter closed, optical axes");
    v("publish_tf", c.publish_tf, "broadcast map -> odom -> base and the two exposure frames");
    v("tf_prediction", c.tf_prediction, 0.0, 60.0,
      "while lost, TF goes on for so long as the camera last moved; 0 = it stops at once [s]");
    v("extrinsic_wait", c.extrinsic_wait, 0.0, 60.0, "longest wait for the transform from base to camera in TF [s]");
    v("stamp_reference", c.stamp_reference, "what the stamps of the images refer to: start, middle or end of exposure");
    v("exposure_time", c.exposure_time, "[s], for all images; auto or nan: from the topic exposure, if any");
    v("exposure_wait", c.exposure_wait, 0.0, 10.0, "longest wait of an image for its exposure message [s]");
    v("calibration_wait", c.calibration_wait, 0.0, 60.0, "longest wait of an image for the first camera_info [s]");
    v("depth_wait", c.depth_wait, 0.0, 10.0, "longest wait of an image for its depth image, where there are any [s]");
    v("depth_tolerance", c.depth_tolerance, 0.0, 1.0, "most time between an image and its depth image [s]");
    v("depth_transport", c.depth_transport, "image_transport of the depth images: raw, compressed (png), ...");
    v("image_transport", c.image_transport,
      "image_transport of the input: raw, compressed (jpeg, png), or a plugin that is installed");
    v("rectified", c.rectified, "the images are rectified already: P of camera_info, no distortion");
    v("no_image_warning", c.no_image_warning, 0.1, 3600.0, "silence at the input after which the status says so [s]");
    v("image_queue_mb", c.image_queue_mb, 0.1, 65536.0, "bound of the images waiting for the tracker [MB]");
    v("mapper_queue_mb", c.mapper_queue_mb, 0.1, 65536.0, "bound of the tracked frames waiting for the mapper [MB]");
    v("path_period", c.path_period, 0.0, 3600.0, "shortest time between two messages on path [s]");
    v("points_period", c.points_period, 0.0, 3600.0, "shortest time between two messages on points [s]");
    v("record", c.record,
      "write down what is published: online_trajectory.txt, online_exposure_trajectory.txt, online_odometry.txt, "
      "frames.csv");
    v("save_on_shutdown", c.save_on_shutdown, "do as save_trajectory does when the mapper ends");
    v("map_file", c.map_file, "map of an earlier run (save_map), in which the camera is looked for at the start");
    v("output_directory", c.output_directory,
      "where that, save_trajectory and save_map go; relative to the node's working directory");
    OdometryConfig::describe(c.odometry, v);
  }

  StampReference stampReference() const { return parseStampReference(stamp_reference); }
  /// nullopt = auto. Throws std::invalid_argument naming the value if it is no time.
  std::optional<double> fixedExposure() const;
};

/// An exposure [s] from 0 to 10, or nullopt for "auto" and "nan". Throws std::invalid_argument naming the key and the
/// text otherwise.
std::optional<double> parseExposure(const std::string& key, const std::string& text);

/// Reads and validates a tree of parameters. Throws std::invalid_argument naming the key, the value and what is
/// allowed.
NodeConfig parseNodeConfig(const YAML::Node& parameters);

/// All parameters in the namespace of `nh`, without those of the nodelets and their manager themselves. In the global
/// namespace, which others use too, only the known ones.
YAML::Node readParameters(const ros::NodeHandle& nh);

}  // namespace mba_vo
