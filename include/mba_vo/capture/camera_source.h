#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>

#include <opencv2/core.hpp>

namespace mba_vo {

struct CapturedImage {
  cv::Mat image;                     // 8 or 16 bit, grey or BGR; never empty
  std::int64_t mid_exposure_ns = 0;  // middle of the exposure of the middle row, wall clock [ns since 1970]
  std::optional<double> exposure;    // [s]; nullopt = unknown
  std::uint64_t number = 0;          // counts on; a gap is an image that the camera took and nobody got
};

/// Something that the user should read.
struct CameraNotice {
  bool warning = false;
  std::string text;
};

/// A recording has been played to its end; so will say every further call.
struct EndOfRecording {};

/// std::monostate: nothing new within the time allowed.
using CameraEvent = std::variant<std::monostate, CapturedImage, CameraNotice, EndOfRecording>;

/// The camera cannot be used. The message names it, what is wrong, and what would be right.
class CameraError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The camera worked, and is gone: unplugged, or silent for too long.
class CameraLost : public CameraError {
 public:
  using CameraError::CameraError;
};

/// What images come from at their own rate: a camera, or a recording that is played like one.
class CameraSource {
 public:
  virtual ~CameraSource() = default;
  /// The next thing to know. Waits for it at most about `timeout_ns` [ns]. Throws CameraLost if no image can follow.
  virtual CameraEvent next(std::int64_t timeout_ns) = 0;
  /// File with the calibration that came with the recording; empty if none did.
  virtual std::string calibrationFile() const { return ""; }
};

}  // namespace mba_vo
