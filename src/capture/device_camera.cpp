#include "mba_vo/capture/device_camera.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "mba_vo/capture/pixel_decoder.h"

namespace mba_vo {
namespace {

constexpr std::int64_t kSilence = 5'000'000'000;     // longer than any exposure, and the start of any webcam [ns]
constexpr std::int64_t kTellPeriod = 5'000'000'000;  // [ns]
constexpr std::int64_t kNanoseconds = 1'000'000;     // per millisecond
constexpr double kOtherRate = 0.05;                  // relative

}  // namespace

DeviceCamera::DeviceCamera(std::shared_ptr<DeviceCalls> calls, std::shared_ptr<Clock> clock,
                           const DeviceSettings& settings)
    : clock_(std::move(clock)),
      settings_(settings),
      device_(std::move(calls), settings.path),
      format_(device_.configure(choose())),
      exposure_(device_, settings.exposure, format_.rate > 0.0 ? 1.0 / format_.rate : 0.0),
      last_image_ns_(clock_->monotonicNow()) {
  warn();
  device_.start();
}

void DeviceCamera::warn() {
  std::vector<std::string> warnings = exposure_.warnings();
  const double wanted = settings_.format.rate;
  if (wanted > 0.0 && std::abs(format_.rate - wanted) > kOtherRate * wanted) {
    std::ostringstream text;
    text << "asked for " << wanted << " Hz the camera ";
    if (format_.rate > 0.0) {
      text << "takes " << format_.rate << " Hz";
    } else {
      text << "does not tell its rate";
    }
    warnings.push_back(text.str());
  }
  if (device_.control(V4L2_CID_FOCUS_AUTO) && device_.value(V4L2_CID_FOCUS_AUTO).value_or(0) != 0) {
    warnings.emplace_back(
        "the camera focuses by itself, which changes its focal length; fix it with v4l2-ctl --set-ctrl "
        "focus_automatic_continuous=0");
  }
  for (const std::string& warning : warnings) notices_.push_back({true, device_.path() + ": " + warning});
}

CaptureFormat DeviceCamera::choose() const {
  try {
    return chooseFormat(device_.formats(), settings_.format);
  } catch (const std::invalid_argument& error) {
    throw CameraError(device_.path() + " (" + device_.name() + "): " + error.what());
  }
}

void DeviceCamera::announce(const BufferStamp& stamp) {
  announced_ = true;
  notices_.push_back(
      {stamp.clock == StampClock::kArrival, device_.path() + " (" + device_.name() + "): " + describe(format_) + ", " +
                                                exposure_.description() + "; stamps: " + toString(stamp.moment) + ", " +
                                                toString(stamp.clock)});
}

CameraEvent DeviceCamera::next(std::int64_t timeout_ns) {
  CameraEvent event;
  if (notices_.empty()) {
    const auto milliseconds = static_cast<int>(timeout_ns / kNanoseconds);
    const bool any = device_.next(milliseconds, [&](const VideoDevice::Buffer& buffer) { event = take(buffer); });
    const std::int64_t silence = clock_->monotonicNow() - last_image_ns_;
    if (!any && silence > kSilence) {
      throw CameraLost(device_.path() + ": no image for " + std::to_string(silence / 1'000'000'000) + " s");
    }
  } else {
    event = notices_.front();
    notices_.pop_front();
  }
  return event;
}

CameraEvent DeviceCamera::take(const VideoDevice::Buffer& buffer) {
  const BufferStamp stamp = stampOfBuffer(buffer.info, *clock_);
  const std::uint32_t sequence = buffer.info.sequence;
  // Drivers that do not count say 0 for ever.
  const std::uint32_t step = announced_ && sequence > last_sequence_ ? sequence - last_sequence_ : 1;
  number_ += step;
  last_sequence_ = sequence;
  last_image_ns_ = clock_->monotonicNow();
  if (!announced_) announce(stamp);
  DecodedImage decoded;
  if ((buffer.info.flags & V4L2_BUF_FLAG_ERROR) != 0) {
    decoded.problem = "the driver says that data are missing";
  } else {
    decoded = decodeBuffer(buffer, format_, settings_.color);
  }
  if (!decoded.problem.empty()) return tellDamaged(decoded.problem);
  CapturedImage image;
  image.image = decoded.image;
  image.exposure = exposure_.of(image.image, last_image_ns_);
  image.mid_exposure_ns = midExposureOf(stamp, image.exposure, settings_.read_out);
  image.number = number_;
  return image;
}

CameraEvent DeviceCamera::tellDamaged(const std::string& problem) {
  ++damaged_;
  if (damage_told_ns_ > 0 && last_image_ns_ - damage_told_ns_ < kTellPeriod) return std::monostate();
  damage_told_ns_ = last_image_ns_;
  return CameraNotice{true, device_.path() + ": " + std::to_string(damaged_) +
                                " damaged images left out so far; of the last one " + problem};
}

}  // namespace mba_vo
