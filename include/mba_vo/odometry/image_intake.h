#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>

#include "mba_vo/image/frame_builder.h"
#include "mba_vo/odometry/camera_image.h"
#include "mba_vo/odometry/input_guard.h"

namespace mba_vo {

/// The door of the odometry: checks stamps and exposures of camera images and makes frames of them, with the
/// calibration as it is known by now.
class ImageIntake {
 public:
  /// What became of an image.
  struct Result {
    FrameConstPtr frame;                   // null if it is of no use
    std::string reason;                    // why it is not, or what is wrong with its exposure or depth; may be empty
    bool clock_restarted = false;          // its stamp is that of a new start: what went before is over
    bool contradicts_calibration = false;  // that is why it is of no use
    double build_ms = 0.0;                 // time taken to make the frame
  };

  /// `in_background`: corrections of the calibration are worked out meanwhile, so that no image has to wait for them.
  ImageIntake(const FrameBuilderConfig& config, PhotometricCalibration photometric, bool in_background);

  /// `known`: correction to begin with. Throws std::invalid_argument naming what is wrong with the calibration.
  void setCalibration(const CameraCalibration& calibration, const CalibrationCorrection& known);
  bool isCalibrated() const { return builder_ != nullptr; }

  Result take(const CameraImage& image);

  /// Images to come are made as the mapper believes they should be. True if that is news.
  bool correct(const CalibrationCorrection& correction);
  /// Forgets stamps, and the correction but for what was known at first.
  void reset();

 private:
  std::unique_ptr<FrameBuilder> makeBuilder(const CalibrationCorrection& correction) const;
  void adoptCorrected();

  FrameBuilderConfig config_;
  PhotometricCalibration photometric_;
  CalibrationCorrection start_;
  bool in_background_;
  std::optional<CameraCalibration> calibration_;
  std::unique_ptr<FrameBuilder> builder_;
  CalibrationCorrection correction_;                         // that it makes images with, or next_builder_ will
  std::future<std::unique_ptr<FrameBuilder>> next_builder_;  // in the making
  InputGuard guard_;
};

}  // namespace mba_vo
