#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "mba_vo/image/digital_gain.h"
#include "mba_vo/image/frame_builder.h"
#include "mba_vo/image/repeat_detector.h"
#include "mba_vo/image/stamp_smoother.h"
#include "mba_vo/image/static_overlay.h"
#include "mba_vo/image/white_level.h"
#include "mba_vo/odometry/camera_image.h"
#include "mba_vo/odometry/input_guard.h"

namespace mba_vo {

/// The door of the odometry: checks stamps and exposures of camera images, tells those that are sent once more, and
/// makes frames of the others, with the calibration as it is known by now.
class ImageIntake {
 public:
  /// What became of an image.
  struct Result {
    FrameConstPtr frame;                   // null if it is of no use, or repeats an image and not for too long
    std::string reason;                    // why it is not, or what is wrong with its exposure or depth; may be empty
    bool clock_restarted = false;          // its stamp is that of a new start: what went before is over
    bool contradicts_calibration = false;  // that is why it is of no use
    std::optional<std::uint64_t> repeats;  // number of the image that it shows again: no measurement
    double build_ms = 0.0;                 // time taken to make the frame
  };

  /// `in_background`: corrections of the calibration are worked out meanwhile, so that no image has to wait for them.
  ImageIntake(const FrameBuilderConfig& config, PhotometricCalibration photometric, bool in_background);

  /// `known`: correction to begin with. Throws std::invalid_argument naming what is wrong with the calibration.
  void setCalibration(const CameraCalibration& calibration, const CalibrationCorrection& known);
  bool isCalibrated() const { return builder_ != nullptr; }

  Result take(const CameraImage& image);

  /// Images to come are worked on at half their present size, where `image.binning` leaves that open and enough is left
  /// of them. What is to be said of it; empty = nothing changes.
  std::string halve();
  /// Images to come are made as the mapper believes they should be. True if that is news.
  bool correct(const CalibrationCorrection& correction);
  /// Forgets stamps, and the correction but for what was known at first.
  void reset();

 private:
  /// The last image that repeated none.
  struct Original {
    std::uint64_t sequence = 0;
    std::int64_t stamp_ns = 0;
    int repeats = 0;
  };

  bool isRepeat(const CameraImage& image);
  bool isFrozen(std::int64_t stamp_ns) const;
  void build(const CameraImage& image, std::int64_t stamp_shift_ns, const std::optional<double>& exposure,
             Result& result);
  void prepareBuilder();
  std::unique_ptr<FrameBuilder> makeBuilder(const FrameBuilderConfig& config,
                                            const CalibrationCorrection& correction) const;
  void adoptCorrected();
  /// Returns what is to be said of it; may be empty.
  std::string adoptWhiteLevel(const cv::Mat& image);
  /// The same.
  std::string adoptOverlay(const cv::Mat& image);
  /// Built with the gain that suits it.
  FrameConstPtr withGain(const CameraImage& image, std::int64_t mid_exposure_ns, const std::optional<double>& exposure);

  FrameBuilderConfig config_;
  const bool chooses_binning_;
  PhotometricCalibration photometric_;
  CalibrationCorrection start_;
  bool in_background_;
  std::optional<CameraCalibration> calibration_;
  std::unique_ptr<FrameBuilder> builder_;
  CalibrationCorrection correction_;                         // that it makes images with, or next_builder_ will
  std::future<std::unique_ptr<FrameBuilder>> next_builder_;  // in the making
  InputGuard guard_;
  StampSmoother stamps_;
  RepeatDetector repeats_;
  Original original_;
  std::uint64_t last_sequence_ = 0;
  WhiteLevel white_level_;
  DigitalGain gain_;
  StaticOverlay overlay_;
};

}  // namespace mba_vo
