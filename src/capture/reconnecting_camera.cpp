#include "mba_vo/capture/reconnecting_camera.h"

#include <algorithm>

namespace mba_vo {
namespace {

constexpr std::int64_t kRetryPeriod = 500'000'000;  // [ns]

}  // namespace

ReconnectingCamera::ReconnectingCamera(Open open, std::shared_ptr<Clock> clock)
    : open_(std::move(open)), clock_(std::move(clock)), camera_(open_()) {}

CameraEvent ReconnectingCamera::next(std::int64_t timeout_ns) {
  if (!camera_) return tryAgain(timeout_ns);
  try {
    CameraEvent event = camera_->next(timeout_ns);
    if (auto* const image = std::get_if<CapturedImage>(&event)) {
      image->number += first_number_;
      last_number_ = image->number;
    }
    return event;
  } catch (const CameraError& lost) {  // whatever happens to a camera that worked
    camera_.reset();
    last_reason_ = lost.what();
    next_try_ns_ = clock_->monotonicNow() + kRetryPeriod;
    return CameraNotice{true, "LOST " + last_reason_ + "; waiting for it to come back"};
  }
}

CameraEvent ReconnectingCamera::tryAgain(std::int64_t timeout_ns) {
  const std::int64_t wait = next_try_ns_ - clock_->monotonicNow();
  if (wait > 0) {
    clock_->sleepFor(std::min(wait, timeout_ns));
    return std::monostate();
  }
  next_try_ns_ = clock_->monotonicNow() + kRetryPeriod;
  try {
    camera_ = open_();
    first_number_ = last_number_;
    return CameraNotice{false, "FOUND the camera again"};
  } catch (const CameraError& error) {
    // Right after it was plugged in it may still be without permission: that is no reason to give up.
    const bool news = last_reason_ != error.what();
    last_reason_ = error.what();
    return news ? CameraEvent(CameraNotice{true, last_reason_ + "; waiting"}) : CameraEvent();
  }
}

}  // namespace mba_vo
