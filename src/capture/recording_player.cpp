#include "mba_vo/capture/recording_player.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <opencv2/imgproc.hpp>

namespace mba_vo {
namespace {

constexpr std::int64_t kLate = 500'000'000;              // what is worth telling [ns]
constexpr std::int64_t kTellLatePeriod = 5'000'000'000;  // [ns]
constexpr std::int64_t kUsualInterval = 33'000'000;      // where there is but one image [ns]

cv::Mat greyOf(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, image.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace

RecordingPlayer::RecordingPlayer(std::unique_ptr<Recording> recording, std::shared_ptr<Clock> clock, bool loop,
                                 bool color)
    : recording_(std::move(recording)), clock_(std::move(clock)), loop_(loop), color_(color) {
  notices_.push_back({false, recording_->description() + (loop_ ? ", again and again" : "")});
}

void RecordingPlayer::begin() {
  begun_ = true;
  if (!read()) return;
  monotonic_offset_ = clock_->monotonicNow() - waiting_->time_ns;
  wall_offset_ = monotonic_offset_ + wallMinusMonotonic(*clock_);
}

bool RecordingPlayer::read() {
  waiting_ = recording_->next();
  if (!waiting_ && loop_ && any_) {
    recording_->rewind();
    waiting_ = recording_->next();
    if (waiting_) {
      const std::int64_t shift = last_time_ns_ + interval_ns_ - waiting_->time_ns;
      monotonic_offset_ += shift;
      wall_offset_ += shift;
      last_time_ns_ = waiting_->time_ns - interval_ns_;
    }
  }
  ended_ = !waiting_;
  return !ended_;
}

CameraEvent RecordingPlayer::next(std::int64_t timeout_ns) {
  if (!notices_.empty()) {
    const CameraNotice notice = notices_.front();
    notices_.pop_front();
    return notice;
  }
  if (!begun_) begin();
  if (ended_ || (!waiting_ && !read())) return EndOfRecording();
  const std::int64_t exposure_ns = std::llround(1e9 * std::max(0.0, waiting_->exposure.value_or(0.0)));
  const std::int64_t due = waiting_->time_ns + exposure_ns / 2 + monotonic_offset_;
  const std::int64_t wait = due - clock_->monotonicNow();
  if (wait > 0) clock_->sleepFor(std::min(wait, timeout_ns));
  if (wait > timeout_ns) return std::monostate();
  return handOver(-wait);
}

CameraEvent RecordingPlayer::handOver(std::int64_t lateness_ns) {
  const RecordedImage image = *waiting_;
  waiting_.reset();
  interval_ns_ = any_ && image.time_ns > last_time_ns_ ? image.time_ns - last_time_ns_ : kUsualInterval;
  last_time_ns_ = image.time_ns;
  any_ = true;
  ++number_;
  const std::int64_t now = clock_->monotonicNow();
  if (lateness_ns > kLate && (!told_late_ || now - *told_late_ > kTellLatePeriod)) {
    told_late_ = now;
    std::ostringstream text;
    text << "playing is " << 1e-9 * static_cast<double>(lateness_ns)
         << " s behind: to read an image takes longer than they are apart";
    notices_.push_back({true, text.str()});
  }
  if (image.image.empty()) return CameraNotice{true, image.problem};
  CapturedImage captured;
  captured.image = color_ ? image.image : greyOf(image.image);
  captured.mid_exposure_ns = image.time_ns + wall_offset_;
  captured.exposure = image.exposure;
  captured.number = number_;
  return captured;
}

}  // namespace mba_vo
