#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

namespace mba_vo {

struct RecordedImage {
  cv::Mat image;                   // 8 or 16 bit, as it was recorded; empty if it could not be read
  std::int64_t time_ns = 0;        // middle of the exposure, by the recording's own clock
  std::optional<double> exposure;  // [s]; nullopt = unknown
  std::string problem;             // why the image is empty
};

/// Images with times, from the first to the last.
class Recording {
 public:
  virtual ~Recording() = default;
  /// nullopt at the end.
  virtual std::optional<RecordedImage> next() = 0;
  virtual void rewind() = 0;
  /// What it is, for the user: "video.mp4: video 640x480 at 30 Hz".
  virtual std::string description() const = 0;
  /// Calibration that came with it; empty if none did.
  virtual std::string calibrationFile() const { return ""; }
};

/// Opens a video file, a folder of images in the order of their names, or a sequence folder (times.txt, a camera file).
/// `rate` [Hz]: 0 = the recording's own; folders without times have none, and get 30 Hz. `camera`: which one of several
/// in the camera file of a sequence folder; empty = the first. Throws CameraError naming what is missing or wrong.
std::unique_ptr<Recording> openRecording(const std::string& path, double rate, const std::string& images_subfolder,
                                         const std::string& camera = "");

}  // namespace mba_vo
