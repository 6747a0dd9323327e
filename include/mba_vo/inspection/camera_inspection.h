#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "mba_vo/image/camera_calibration.h"
#include "mba_vo/image/repeat_detector.h"
#include "mba_vo/image/white_level.h"
#include "mba_vo/inspection/camera_facts.h"
#include "mba_vo/inspection/image_meter.h"

namespace mba_vo {

/// An image as a recording has it.
struct SeenImage {
  std::int64_t stamp_ns = 0;
  cv::Mat image;              // 8- or 16-bit, 1, 3 (BGR) or 4 channels; empty if it could not be read
  std::string encoding;       // as the recording names it
  std::string problem;        // why it could not be read
  bool bad_encoding = false;  // that is why
};

/// Looks at the images of one camera, one after the other, and keeps what `judge` needs to know of them.
class CameraInspection {
 public:
  void add(const SeenImage& seen);
  void addExposure(std::int64_t stamp_ns, double seconds) { facts_.exposures.push_back({stamp_ns, seconds}); }
  void setCalibration(const CameraCalibration& calibration) { facts_.calibration = calibration; }
  void setResponseKnown() { facts_.response_known = true; }
  void setJpeg() { facts_.jpeg = true; }

  const CameraFacts& facts() const { return facts_; }

 private:
  void measure(const cv::Mat& image, ImageFacts& facts);

  CameraFacts facts_;
  RepeatDetector repeats_;
  WhiteLevel white_level_{0.0};
  MotionMeter motion_;
};

}  // namespace mba_vo
