#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "mba_vo/geometry/calibration_correction.h"
#include "mba_vo/image/camera_calibration.h"
#include "mba_vo/image/frame_builder.h"

namespace mba_vo {

/// What runs learn of a camera, kept in a file from one run to the next (`image.learnt_file`). Safe to use from several
/// threads.
class CameraMemory {
 public:
  /// Without a name in `image`, nothing is kept. What was learnt belongs to the rest of `image`, too.
  explicit CameraMemory(FrameBuilderConfig image) : image_(std::move(image)) {}

  /// What is known of this camera; none if there is no file yet. Throws std::runtime_error naming the file, and what is
  /// wrong, if it cannot be understood or belongs to another camera; nothing is then kept, so that the file stays.
  CalibrationCorrection recall(const CameraCalibration& calibration);

  /// Keeps what is known now of the camera that was recalled last. Written beside the file and then moved there: the
  /// file is whole at any time. Throws std::runtime_error if it cannot be written.
  void keep(const CalibrationCorrection& correction);

 private:
  FrameBuilderConfig image_;
  std::mutex mutex_;
  std::optional<CameraCalibration> calibration_;  // none: nothing may be kept
};

}  // namespace mba_vo
