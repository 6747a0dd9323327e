#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/capture/camera_source.h"
#include "mba_vo/capture/exposure_regulator.h"
#include "mba_vo/capture/video_device.h"

namespace mba_vo {

struct ExposureRequest {
  std::optional<double> seconds;    // [s]; nullopt = automatic
  double longest = 0.0;             // automatic, by this program, up to here [s]; 0 = by the camera
  bool dynamic_frame_rate = false;  // automatic exposure may be longer than the time between two images, which grows
};

/// Judges what a device says about its exposure while it sets it by itself. Many webcams say for ever what was set by
/// hand last: a value is believed only once it has been seen to change, and never where it is longer than images are
/// apart.
class AutomaticReading {
 public:
  /// `longest`: the longest exposure that is possible [s].
  std::optional<double> judge(std::optional<double> reading, double longest);

 private:
  std::optional<double> first_;
  bool changes_ = false;
};

/// Sets the exposure of a device, and tells what it is. Controls: exposure_auto, exposure_absolute,
/// exposure_auto_priority (now called auto_exposure, exposure_time_absolute, exposure_dynamic_framerate).
class ExposureControl {
 public:
  /// `frame_interval`: time between two images [s], 0 = unknown. Throws CameraError naming the value and what is
  /// allowed.
  ExposureControl(VideoDevice& device, const ExposureRequest& request, double frame_interval);

  /// What was set, for the user; and what he should know about it.
  const std::string& description() const { return description_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Exposure of an image that came now [s]; nullopt = unknown. `now_ns`: monotonic clock.
  std::optional<double> of(const cv::Mat& image, std::int64_t now_ns);

 private:
  v4l2_queryctrl requireRange() const;
  int setManual(double wanted);
  void fix(double wanted);
  void setRegulated(double longest);
  void regulate(const cv::Mat& image);
  void setAutomatic(bool dynamic_frame_rate);
  bool setMode(const std::vector<int>& modes);
  std::optional<double> read() const;

  VideoDevice& device_;
  double frame_interval_;  // [s]
  double longest_ = 0.0;   // possible automatic exposure [s]
  bool automatic_ = false;
  std::optional<double> exposure_;  // [s]
  std::optional<std::int64_t> read_at_;
  AutomaticReading reading_;
  std::optional<ExposureRegulator> regulator_;
  int images_since_change_ = 0;
  std::string description_;
  std::vector<std::string> warnings_;
};

}  // namespace mba_vo
