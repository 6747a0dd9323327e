#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "mba_vo/geometry/calibration_correction.h"
#include "mba_vo/image/image_pyramid.h"

namespace mba_vo {

/// A camera image, ready for tracking: rectified, linear in light, with the time of mid-exposure.
struct Frame {
  std::uint64_t sequence = 0;        // number of the image at the input, gaps are lost images
  std::int64_t stamp_ns = 0;         // stamp of the input message, whatever it refers to [ns]
  std::int64_t mid_exposure_ns = 0;  // time of mid-exposure [ns]
  std::optional<double> exposure;    // [s]; nullopt = unknown, 0 = instantaneous
  double exposure_log_sigma = 0.0;   // standard deviation of its logarithm; 0 = it came with the image
  ImagePyramid pyramid;
  cv::Mat1f depth;      // z of the finest level's pixels [m], NaN = unknown; empty = none. Not to be written
  cv::Mat1b overlay;    // 255 where something covers the scene in the camera's image and is masked; empty = nowhere
  bool masked = false;  // a large part of it, by that or by a mask
  CalibrationCorrection correction;  // of the calibration, that the image was made with or its camera has

  double midExposureSeconds() const { return 1e-9 * static_cast<double>(mid_exposure_ns); }
  bool exposureWasTold() const { return exposure && exposure_log_sigma == 0.0; }
};

using FrameConstPtr = std::shared_ptr<const Frame>;

/// The same frame with another exposure; the image is shared.
inline FrameConstPtr withExposure(const FrameConstPtr& frame, const std::optional<double>& exposure,
                                  double exposure_log_sigma) {
  if (exposure == frame->exposure && exposure_log_sigma == frame->exposure_log_sigma) return frame;
  auto other = std::make_shared<Frame>(*frame);
  other->exposure = exposure;
  other->exposure_log_sigma = exposure_log_sigma;
  return other;
}

/// The same frame with a camera that comes nearest to another correction (pinholePart); the image is shared.
inline FrameConstPtr withCamera(const FrameConstPtr& frame, const CalibrationCorrection& correction) {
  const CalibrationCorrection lacking =
      pinholePart(frame->correction.lacks(correction), frame->pyramid.level(0).camera);
  if (lacking.isZero()) return frame;
  auto other = std::make_shared<Frame>(*frame);
  other->pyramid.correctCamera(lacking);
  other->correction.values += lacking.values;
  return other;
}

}  // namespace mba_vo
