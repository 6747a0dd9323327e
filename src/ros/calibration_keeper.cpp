#include "mba_vo/ros/calibration_keeper.h"

#include <cmath>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include <ros/package.h>

#include "mba_vo/io/camera_file.h"
#include "mba_vo/ros/camera_info.h"

namespace mba_vo {
namespace {

constexpr const char* kOwnPlace = "file://${ROS_HOME}/camera_info/${NAME}.yaml";

std::string asUrl(const std::string& url) {
  if (url.empty()) return kOwnPlace;
  return url.front() == '/' ? "file://" + url : url;
}

[[noreturn]] void refuseUrl(const std::string& url) {
  throw std::invalid_argument("camera_info_url is '" + url +
                              "'; allowed: an absolute path, file:///... or package://...");
}

/// Of an URL without variables.
std::string fileOf(const std::string& url) {
  const std::string file = "file://", package = "package://";
  if (url.rfind(file + "/", 0) == 0) return url.substr(file.size());
  const std::size_t slash = url.find('/', package.size());
  if (url.rfind(package, 0) != 0 || slash == std::string::npos) refuseUrl(url);
  const std::string name = url.substr(package.size(), slash - package.size());
  const std::string folder = ros::package::getPath(name);
  if (folder.empty())
    throw std::invalid_argument("camera_info_url is '" + url + "': there is no package '" + name + "'");
  return folder + url.substr(slash);
}

}  // namespace

CalibrationKeeper::CalibrationKeeper(const ros::NodeHandle& nh, const std::string& camera_name, const std::string& url,
                                     double field_of_view, const std::string& camera)
    : manager_(nh, camera_name), field_of_view_(field_of_view) {
  const bool good_name = manager_.setCameraName(camera_name);
  if (!good_name) throw std::invalid_argument("camera_name is '" + camera_name + "'; allowed: letters, digits and _");
  if (!manager_.validateURL(asUrl(url))) refuseUrl(url);
  place_ = fileOf(manager_.resolveURL(asUrl(url), camera_name));
  read(asUrl(url), camera);
}

/// Files that are not of ROS are never written to: what set_camera_info brings goes to camera_info_manager's own place.
void CalibrationKeeper::read(const std::string& url, const std::string& camera) {
  if (!std::filesystem::exists(place_)) {
    if (!camera.empty()) {
      throw std::runtime_error(place_ + ": there is no such calibration, from which camera '" + camera +
                               "' could be chosen");
    }
    manager_.loadCameraInfo(url);
    return;
  }
  const CameraFile file = readChosenCamera(place_, camera);
  if (file.of_ros) manager_.loadCameraInfo(url);  // it reads the projection of rectified images, too
  if (!file.of_ros || !manager_.isCalibrated()) manager_.setCameraInfo(cameraInfoFromCalibration(file.calibration));
}

sensor_msgs::CameraInfo CalibrationKeeper::infoFor(const cv::Size& size) {
  if (manager_.isCalibrated()) return manager_.getCameraInfo();
  if (field_of_view_ > 0.0) return guessedCameraInfo(size, field_of_view_);
  sensor_msgs::CameraInfo unknown;
  unknown.width = static_cast<std::uint32_t>(size.width);
  unknown.height = static_cast<std::uint32_t>(size.height);
  return unknown;
}

std::string CalibrationKeeper::problem(const cv::Size& size) {
  std::ostringstream text;
  const sensor_msgs::CameraInfo info = infoFor(size);
  if (!manager_.isCalibrated() && field_of_view_ > 0.0) {
    text << "the camera is not calibrated (" << place_ << "): a field of view of " << field_of_view_
         << " degrees and a lens without distortion are assumed. Record a bag; mba_vo_calibrate makes a calibration of "
            "it, "
            "for camera_info_url";
  } else if (!manager_.isCalibrated()) {
    text << "the camera is not calibrated (" << place_
         << "): the odometry will not take its images. Name a calibration (camera_info_url:=/absolute/camera.yaml), or "
            "tell "
            "the horizontal field of view in degrees (field_of_view:=60), record a bag, and mba_vo_calibrate makes one "
            "of it";
  } else if (static_cast<int>(info.width) != size.width || static_cast<int>(info.height) != size.height) {
    text << "the calibration (" << place_ << ") is that of images of " << info.width << "x" << info.height
         << ", the camera's have " << size.width << "x" << size.height << ": the odometry will not take them";
  }
  return text.str();
}

sensor_msgs::CameraInfo guessedCameraInfo(const cv::Size& size, double field_of_view) {
  constexpr double kHalfDegree = M_PI / 360.0;  // [rad]
  CameraCalibration calibration;
  calibration.width = size.width;
  calibration.height = size.height;
  calibration.fx = calibration.fy = 0.5 * size.width / std::tan(kHalfDegree * field_of_view);
  calibration.cx = 0.5 * (size.width - 1);
  calibration.cy = 0.5 * (size.height - 1);
  calibration.distortion.assign(5, 0.0);
  return cameraInfoFromCalibration(calibration);
}

}  // namespace mba_vo
