#include "mba_vo/capture/exposure_control.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace mba_vo {
namespace {

constexpr double kUnit = 1e-4;                        // of V4L2_CID_EXPOSURE_ABSOLUTE [s]
constexpr double kLongest = 10.0;                     // where the rate gives way to the exposure [s]
constexpr double kRounding = 1.02;                    // times are whole units, and rates are rounded
constexpr int kImagesOnTheWay = 6;                    // in the camera, on the bus and in the driver's buffers
constexpr std::int64_t kReadingPeriod = 200'000'000;  // a reading is a transfer on the bus, and takes milliseconds [ns]

std::string milliseconds(double seconds) {
  std::ostringstream text;
  text << 1e3 * seconds << " ms";
  return text.str();
}

std::string seconds(double value) {
  std::ostringstream text;
  text << value << " s";
  return text.str();
}

}  // namespace

std::optional<double> AutomaticReading::judge(std::optional<double> reading, double longest) {
  if (!reading) return std::nullopt;
  if (!first_) first_ = reading;
  changes_ = changes_ || *reading != *first_;
  const bool possible = *reading > 0.0 && *reading <= longest;
  return changes_ && possible ? reading : std::nullopt;
}

ExposureControl::ExposureControl(VideoDevice& device, const ExposureRequest& request, double frame_interval)
    : device_(device), frame_interval_(frame_interval) {
  if (request.seconds) {
    fix(*request.seconds);
  } else if (request.longest > 0.0) {
    setRegulated(request.longest);
  } else {
    setAutomatic(request.dynamic_frame_rate);
  }
}

bool ExposureControl::setMode(const std::vector<int>& modes) {
  return std::any_of(modes.begin(), modes.end(), [this](int mode) {
    return device_.hasMenuItem(V4L2_CID_EXPOSURE_AUTO, static_cast<std::uint32_t>(mode)) &&
           device_.setValue(V4L2_CID_EXPOSURE_AUTO, mode);
  });
}

v4l2_queryctrl ExposureControl::requireRange() const {
  const auto range = device_.control(V4L2_CID_EXPOSURE_ABSOLUTE);
  if (!range) throw CameraError(device_.path() + ": its exposure cannot be set; use exposure auto");
  return *range;
}

/// Returns what was set, in units; exposure_ becomes what the camera says it took.
int ExposureControl::setManual(double wanted) {
  const v4l2_queryctrl range = requireRange();
  const int step = std::max(range.step, 1);
  const int units = range.minimum + step * static_cast<int>(std::lround((wanted / kUnit - range.minimum) / step));
  if (units < range.minimum || units > range.maximum) {
    throw CameraError(device_.path() + ": exposure is " + seconds(wanted) + "; this camera allows " +
                      seconds(kUnit * range.minimum) + " to " + seconds(kUnit * range.maximum));
  }
  const bool has_modes = device_.control(V4L2_CID_EXPOSURE_AUTO).has_value();
  if (has_modes && !setMode({V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_SHUTTER_PRIORITY})) {
    throw CameraError(device_.path() + ": it does not let its exposure be set by hand; use exposure auto");
  }
  if (!device_.setValue(V4L2_CID_EXPOSURE_ABSOLUTE, units)) {
    throw CameraError(device_.path() + ": it refuses an exposure of " + seconds(wanted));
  }
  exposure_ = read().value_or(kUnit * units);
  return units;
}

void ExposureControl::fix(double wanted) {
  const int units = setManual(wanted);
  description_ = "exposure " + milliseconds(*exposure_);
  if (std::abs(*exposure_ - kUnit * units) > 0.5 * kUnit) {
    warnings_.push_back("asked for an exposure of " + milliseconds(wanted) + " the camera says " +
                        milliseconds(*exposure_));
  }
  if (frame_interval_ > 0.0 && *exposure_ > kRounding * frame_interval_) {
    warnings_.push_back("an exposure of " + milliseconds(*exposure_) + " is longer than images are apart (" +
                        milliseconds(frame_interval_) + "): they will come more slowly");
  }
}

void ExposureControl::setRegulated(double longest) {
  const v4l2_queryctrl range = requireRange();
  ExposureRegulator::Limits limits;
  limits.min_exposure = kUnit * std::max(range.minimum, 1);
  limits.max_exposure = std::min(longest, kUnit * range.maximum);
  if (limits.max_exposure < limits.min_exposure) {
    throw CameraError(device_.path() + ": max_exposure is " + seconds(longest) +
                      "; the shortest exposure of this camera is " + seconds(limits.min_exposure));
  }
  if (device_.control(V4L2_CID_AUTOGAIN)) device_.setValue(V4L2_CID_AUTOGAIN, 0);
  if (const auto gain = device_.control(V4L2_CID_GAIN)) {
    limits.min_gain = gain->minimum;
    limits.max_gain = gain->maximum;
  }
  regulator_.emplace(limits);
  setManual(regulator_->setting().exposure);
  if (limits.max_gain > limits.min_gain) device_.setValue(V4L2_CID_GAIN, limits.min_gain);
  description_ = "exposure automatic up to " + milliseconds(limits.max_exposure);
}

void ExposureControl::setAutomatic(bool dynamic_frame_rate) {
  automatic_ = true;
  longest_ = dynamic_frame_rate || frame_interval_ <= 0.0 ? kLongest : kRounding * frame_interval_;
  description_ = "exposure automatic";
  const bool has_modes = device_.control(V4L2_CID_EXPOSURE_AUTO).has_value();
  if (has_modes && !setMode({V4L2_EXPOSURE_APERTURE_PRIORITY, V4L2_EXPOSURE_AUTO})) {
    warnings_.emplace_back("the camera refuses automatic exposure; it stays as it is");
  }
  if (device_.control(V4L2_CID_EXPOSURE_AUTO_PRIORITY)) {
    const bool set = device_.setValue(V4L2_CID_EXPOSURE_AUTO_PRIORITY, dynamic_frame_rate ? 1 : 0);
    if (!set)
      warnings_.emplace_back("the camera does not let exposure_dynamic_framerate be set; it may slow down in the dark");
    if (set && !dynamic_frame_rate) description_ += ", never longer than images are apart";
  }
  if (!device_.control(V4L2_CID_EXPOSURE_ABSOLUTE)) description_ += ", unknown: the camera does not tell it";
}

std::optional<double> ExposureControl::read() const {
  const auto value = device_.value(V4L2_CID_EXPOSURE_ABSOLUTE);
  return value ? std::make_optional(kUnit * *value) : std::nullopt;
}

std::optional<double> ExposureControl::of(const cv::Mat& image, std::int64_t now_ns) {
  if (regulator_) {
    // Images that are on their way were exposed before the change.
    const bool settled = ++images_since_change_ > kImagesOnTheWay;
    const std::optional<double> exposure = settled ? exposure_ : std::nullopt;
    if (settled) regulate(image);
    return exposure;
  }
  if (automatic_ && (!read_at_ || now_ns - *read_at_ >= kReadingPeriod)) {
    read_at_ = now_ns;
    exposure_ = reading_.judge(read(), longest_);
  }
  return exposure_;
}

void ExposureControl::regulate(const cv::Mat& image) {
  constexpr double kWhite = 255.0;
  const cv::Scalar mean = cv::mean(image);
  const double level = cv::sum(mean)[0] / (kWhite * image.channels());
  const int gain = regulator_->setting().gain;
  const auto setting = regulator_->update(level);
  if (!setting) return;
  images_since_change_ = 0;
  if (setting->gain != gain) {
    device_.setValue(V4L2_CID_GAIN, setting->gain);
  } else {
    setManual(setting->exposure);
  }
}

}  // namespace mba_vo
