#include "mba_vo/odometry/image_intake.h"

#include <chrono>
#include <stdexcept>
#include <utility>

namespace mba_vo {
namespace {

void append(std::string& text, const std::string& more) {
  if (!more.empty()) text += (text.empty() ? "" : "; ") + more;
}

}  // namespace

ImageIntake::ImageIntake(const FrameBuilderConfig& config, PhotometricCalibration photometric, bool in_background)
    : config_(config), photometric_(std::move(photometric)), in_background_(in_background) {}

void ImageIntake::setCalibration(const CameraCalibration& calibration, const CalibrationCorrection& known) {
  calibration_ = calibration;
  correction_ = start_ = known;
  next_builder_ = {};
  builder_ = makeBuilder(correction_);
}

ImageIntake::Result ImageIntake::take(const CameraImage& image) {
  Result result;
  if (image.image.empty() || !builder_) {
    result.reason = builder_ ? image.problem : "no calibration yet";
    return result;
  }
  InputVerdict verdict = guard_.check(image.stamp_ns, image.exposure);
  if (verdict.clock_restarted) {
    result.clock_restarted = true;
    result.reason = verdict.reason + ": taken for a new start";
    reset();
    verdict = guard_.check(image.stamp_ns, image.exposure);
  }
  append(result.reason, verdict.reason);
  append(result.reason, image.problem);
  if (!verdict.accepted) return result;
  adoptCorrected();
  const auto begin = std::chrono::steady_clock::now();
  try {
    // Without an exposure the stamp is all that is known.
    const std::int64_t mid_exposure_ns = image.exposure && !verdict.exposure ? image.stamp_ns : image.mid_exposure_ns;
    result.frame =
        builder_->build(image.image, image.sequence, image.stamp_ns, mid_exposure_ns, verdict.exposure, image.depth);
  } catch (const std::invalid_argument& error) {
    result.reason = error.what();
    result.contradicts_calibration = true;
  }
  result.build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

bool ImageIntake::correct(const CalibrationCorrection& correction) {
  if (!builder_ || correction == correction_) return false;
  correction_ = correction;
  if (!in_background_) {
    builder_->correct(correction);
    return true;
  }
  // Making its maps takes longer than tracking an image: images go on being made as before meanwhile.
  next_builder_ = std::async(std::launch::async, [this, correction] { return makeBuilder(correction); });
  return true;
}

void ImageIntake::reset() {
  guard_.reset();
  next_builder_ = {};
  correction_ = start_;
  if (builder_) builder_->correct(correction_);
}

std::unique_ptr<FrameBuilder> ImageIntake::makeBuilder(const CalibrationCorrection& correction) const {
  auto builder = std::make_unique<FrameBuilder>(*calibration_, photometric_, config_);
  builder->correct(correction);
  return builder;
}

void ImageIntake::adoptCorrected() {
  if (next_builder_.valid() && next_builder_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    builder_ = next_builder_.get();
  }
}

}  // namespace mba_vo
