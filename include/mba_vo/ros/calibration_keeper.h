#pragma once

#include <string>

#include <camera_info_manager/camera_info_manager.h>
#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>
#include <opencv2/core.hpp>

namespace mba_vo {

/// The camera_info of a camera: of a calibration file of any kind (readCameraFile), or guessed. camera_info_manager
/// reads those of ROS, and serves set_camera_info.
class CalibrationKeeper {
 public:
  /// `url`: URL or absolute path; empty = camera_info_manager's own place. `field_of_view`: horizontal [deg], 0 =
  /// unknown. `camera`: which one of several in the file; empty = the first. Throws std::invalid_argument for an URL
  /// that cannot be one, and std::runtime_error naming what is wrong with the file, if there is one.
  CalibrationKeeper(const ros::NodeHandle& nh, const std::string& camera_name, const std::string& url,
                    double field_of_view, const std::string& camera = "");

  /// For images of this size; K is zero if nothing is known.
  sensor_msgs::CameraInfo infoFor(const cv::Size& size);
  /// What the user has to know about the calibration of such images; empty if all is well.
  std::string problem(const cv::Size& size);

 private:
  void read(const std::string& url, const std::string& camera);

  camera_info_manager::CameraInfoManager manager_;
  std::string place_;  // where the calibration is looked for
  double field_of_view_;
};

/// A first guess: pinhole, no distortion, square pixels, `field_of_view` [deg] from the left edge to the right one.
sensor_msgs::CameraInfo guessedCameraInfo(const cv::Size& size, double field_of_view);

}  // namespace mba_vo
