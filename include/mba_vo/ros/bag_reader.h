#pragma once

#include <memory>
#include <optional>
#include <string>

#include "mba_vo/io/sequence.h"
#include "mba_vo/ros/conversions.h"

namespace mba_vo {

/// Which topics of a bag to read. An empty name is found by type, if there is no choice.
struct BagTopics {
  std::string image;              // sensor_msgs/Image or sensor_msgs/CompressedImage
  std::string camera_info;        // sensor_msgs/CameraInfo; preferred: beside the image topic
  std::string exposure;           // mba_vo/ExposureStamped; without one the exposure is unknown
  std::string depth;              // sensor_msgs/Image as in REP-118; none if not named
  double depth_tolerance = 0.02;  // between the stamps of an image and its depth image [s]
  StampReference stamp_reference = StampReference::kMiddle;
  bool rectified = false;                          // the images are rectified already: use P, no distortion
  std::optional<CameraCalibration> calibration{};  // in place of camera_info, which is then not needed
};

/// Topics below this namespace are ground truth; they are never read.
extern const char* const kGroundTruthNamespace;

/// Opens a rosbag without a ROS master. Throws std::runtime_error naming the file, or the topics there are to choose
/// from, or what is wrong with the camera_info.
std::unique_ptr<SequenceReader> openBag(const std::string& file, const BagTopics& topics);

}  // namespace mba_vo
