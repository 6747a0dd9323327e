#pragma once

#include <sensor_msgs/CameraInfo.h>

#include "mba_vo/image/frame_builder.h"

namespace mba_vo {

/// Calibration of the images as they are delivered: binning and region of interest are applied. With `rectified` the
/// images have been rectified by someone else: P without distortion. Throws std::invalid_argument naming the value for
/// a camera that was never calibrated (zero K) or an impossible binning, region, model or size.
CameraCalibration calibrationFromCameraInfo(const sensor_msgs::CameraInfo& info, bool rectified = false);

/// K, D and P of full-resolution images; the header stays empty.
sensor_msgs::CameraInfo cameraInfoFromCalibration(const CameraCalibration& calibration);

bool operator==(const CameraCalibration& a, const CameraCalibration& b);

}  // namespace mba_vo
