#pragma once

#include <memory>
#include <mutex>
#include <string>

#include <sensor_msgs/CameraInfo.h>

#include "mba_vo/image/frame_builder.h"

namespace mba_vo {

/// Newest calibration that camera_info has told, or why there is none. Thread-safe.
class CalibrationStore {
 public:
  CalibrationStore(const std::string& topic, bool rectified)
      : rectified_(rectified), problem_("no calibration: no message on " + topic + " yet") {}

  /// Returns true if there is a calibration now.
  bool set(const sensor_msgs::CameraInfo& info);
  /// Null if there is none yet. The same pointer as long as the calibration stays the same.
  std::shared_ptr<const CameraCalibration> get() const;
  /// Why there is no calibration; empty if there is one.
  std::string problem() const;

 private:
  const bool rectified_;
  mutable std::mutex mutex_;
  std::shared_ptr<const CameraCalibration> calibration_;
  std::string problem_;
};

}  // namespace mba_vo
