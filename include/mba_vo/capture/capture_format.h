#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace mba_vo {

/// Image sizes that a device offers, in steps [px]. A single size has the same least and largest.
struct SizeRange {
  int min_width = 0, max_width = 0, step_width = 1;
  int min_height = 0, max_height = 0, step_height = 1;
};

/// Rates [Hz]; a single one has the same least and largest.
struct RateRange {
  double min = 0.0, max = 0.0;
};

/// A pixel format (V4L2_PIX_FMT_...) with sizes, and the rates it has there. No rates: the device does not tell them.
struct OfferedFormat {
  std::uint32_t fourcc = 0;
  SizeRange size;
  std::vector<RateRange> rates;
};

/// What the user wants. 0 and "auto": as it suits an odometry.
struct FormatRequest {
  std::string pixel_format = "auto";  // auto, mjpeg, yuyv or grey
  int width = 0, height = 0;          // [px]; both or none
  double rate = 0.0;                  // [Hz]
};

struct CaptureFormat {
  std::uint32_t fourcc = 0;
  int width = 0, height = 0;  // [px]
  double rate = 0.0;          // [Hz]; 0 = the device does not tell
};

/// The offer that fits. What is left open is chosen: the size next to 640x480, the rate next to 30 Hz, then grey or
/// YUYV before MJPEG. Throws std::invalid_argument naming what was wanted and what is offered in its place.
CaptureFormat chooseFormat(const std::vector<OfferedFormat>& offered, const FormatRequest& request);

/// For the user: one line for each offered size, and "YUYV 640x480 at 30 Hz".
std::string describe(const std::vector<OfferedFormat>& offered);
std::string describe(const CaptureFormat& format);

}  // namespace mba_vo
