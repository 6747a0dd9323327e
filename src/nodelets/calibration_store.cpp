#include "calibration_store.h"

#include <stdexcept>

#include "mba_vo/ros/camera_info.h"

namespace mba_vo {

bool CalibrationStore::set(const sensor_msgs::CameraInfo& info) {
  const std::lock_guard<std::mutex> lock(mutex_);
  try {
    const CameraCalibration calibration = calibrationFromCameraInfo(info, rectified_);
    if (!calibration_ || !(*calibration_ == calibration)) {
      calibration_ = std::make_shared<const CameraCalibration>(calibration);
    }
    problem_.clear();
  } catch (const std::invalid_argument& error) {
    problem_ = error.what();
    calibration_.reset();
  }
  return calibration_ != nullptr;
}

std::shared_ptr<const CameraCalibration> CalibrationStore::get() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return calibration_;
}

std::string CalibrationStore::problem() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return problem_;
}

}  // namespace mba_vo
