#include "mba_vo/mapping/map_health.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "mba_vo/image/image_content.h"
#include "mba_vo/tracking/reference.h"

namespace mba_vo {
namespace {

constexpr std::size_t kYoung = 6;             // keyframes
constexpr std::size_t kLeastHistory = 4;      // keyframes of which the quartile means something
constexpr std::size_t kMostKeyframes = 1000;  // of which the errors are remembered
constexpr std::size_t kMostFrames = 101;
constexpr int kWrongInARow = 2;
constexpr std::size_t kFirstFrames = 16;  // docs/decisions/2026-11-29-first-frames.md
constexpr int kMostContradicted = 2;      // maps in a row

template <typename Values>
double quantile(const Values& values, double level) {
  if (values.empty()) return 0.0;
  std::vector<double> sorted(values.begin(), values.end());
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(level * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at;
}

}  // namespace

double keyframeError(double rms, const Reference& keyframe) {
  std::vector<Eigen::Vector2d> pixels;
  for (const ReferencePoint& point : keyframe.points) pixels.push_back(point.pixel.cast<double>());
  const double gradient = rmsGradient(keyframe.pyramid->level(0), pixels);
  return gradient > 0.0 ? rms / gradient : 0.0;
}

void MapHealth::reset() {
  const int contradicted = contradicted_in_a_row_;
  *this = MapHealth(config_);
  contradicted_in_a_row_ = contradicted;
}

double MapHealth::limit() const {
  if (errors_.size() < kLeastHistory) return config_.max_error;
  return std::min(config_.max_error, quantile(errors_, 0.25) + config_.max_rise);
}

bool MapHealth::isYoung() const { return errors_.size() <= kYoung; }

void MapHealth::addKeyframe(double error) {
  errors_.push_back(error);
  if (errors_.size() > kMostKeyframes) errors_.erase(errors_.begin());
  bad_in_a_row_ = error > limit() ? bad_in_a_row_ + 1 : 0;
  wrong_in_a_row_ = error > config_.wrong_error ? wrong_in_a_row_ + 1 : 0;
}

void MapHealth::addDepths(const DepthAgreement& depths) { depths_ = depths; }

void MapHealth::addFrame(double error) {
  frame_errors_.push_back(error);
  if (frame_errors_.size() > kMostFrames) frame_errors_.pop_front();
  if (!judges_beginning_ || frame_errors_.size() != kFirstFrames) return;
  contradicted_ = usualFrameError() > config_.max_error;
  contradicted_in_a_row_ = contradicted_ ? contradicted_in_a_row_ + 1 : 0;
}

bool MapHealth::beganWrong() const { return contradicted_ && contradicted_in_a_row_ <= kMostContradicted; }

bool MapHealth::isWrong() const {
  return depths_.fails() || beganWrong() || wrong_in_a_row_ >= (isYoung() ? 1 : kWrongInARow);
}

std::string MapHealth::doubt() const {
  std::array<char, 128> text{};
  if (depths_.fails()) {
    std::snprintf(text.data(), text.size(), "the images contradict the depth images (%d of %d points agree)",
                  depths_.agreeing, depths_.compared);
    return text.data();
  }
  if (beganWrong()) {
    std::snprintf(text.data(), text.size(), "its first frames contradict it by %.1f px (limit %.1f px)",
                  usualFrameError(), config_.max_error);
    return text.data();
  }
  if (bad_in_a_row_ == 0) return "";
  std::snprintf(text.data(), text.size(), "the map contradicts its own keyframes by %.1f px (limit %.1f px)",
                lastKeyframeError(), limit());
  return text.data();
}

double MapHealth::usualFrameError() const { return quantile(frame_errors_, 0.5); }

}  // namespace mba_vo
