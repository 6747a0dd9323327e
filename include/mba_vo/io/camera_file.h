#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/geometry/se3.h"
#include "mba_vo/image/camera_calibration.h"

namespace mba_vo {

/// What a calibration file tells of one camera.
struct CameraFile {
  CameraCalibration calibration;
  std::string form;                  // of the file, for messages
  std::optional<SE3> T_body_camera;  // of the rig, where the file tells: a Kalibr or ASL file
  bool has_names = false;            // its cameras are called cam0, cam1, ...: one can be chosen
  bool of_ros = false;               // camera_info, as camera_info_manager writes it
};

/// Reads the calibration of a camera; what kind of file it is shows when one looks at it:
///   - ROS camera_info, as YAML or INI (camera_calibration, camera_info_manager);
///   - Kalibr's camchain (camera_model pinhole; distortion_model radtan, equidistant, fov or none);
///   - sensor.yaml of an ASL folder (EuRoC);
///   - camera.txt of TUM-mono and DSO: FOV, Pinhole, RadTan, EquiDistant or KannalaBrandt, or no name, and values that
///     are relative to the image (all below 1) or in pixels; the camera of the images, not that of their third line;
///   - `fx fy cx cy` on one line (ETH3D), which needs `image_size`.
/// `camera`: which one of several (cam0, cam1, ...); empty = cam0, or the only one. Throws std::runtime_error naming
/// file, line or key, value, and what is allowed.
CameraFile readCameraFile(const std::string& file, const std::string& camera = "", cv::Size image_size = {});

/// The same for a camera that a user has named, unless `camera` is empty. A file of one camera without a name is then
/// refused, too: nothing can be chosen from it.
CameraFile readChosenCamera(const std::string& file, const std::string& camera, cv::Size image_size = {});

/// T_BS of a sensor.yaml of any sensor: maps its coordinates to those of the body. Nullopt if the file tells none.
std::optional<SE3> readSensorPose(const std::string& file);

/// From 16 numbers, row by row. Throws std::invalid_argument telling what is allowed unless they are a rigid motion.
SE3 poseOfMatrix(const std::vector<double>& values);

/// The first of these that is in the folder: camera.yaml, camera.ini, camera.txt, camchain.yaml, sensor.yaml;
/// camera.yaml if there is none.
std::string cameraFileIn(const std::string& folder);

}  // namespace mba_vo
