#include "mba_vo/odometry/image_intake.h"

#include <algorithm>
#include <chrono>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "mba_vo/image/binning.h"
#include "mba_vo/image/image_content.h"
#include "mba_vo/image/image_noise.h"

namespace mba_vo {
namespace {

constexpr double kLongestRepeat = 0.15;  // [s] after which the camera may be anywhere,
constexpr int kFewRepeats = 2;           // unless it is so slow that these last longer
constexpr int kLeastWidth = 300;         // [px] left of an image that is halved: 640x480 may be

void append(std::string& text, const std::string& more) {
  if (!more.empty()) text += (text.empty() ? "" : "; ") + more;
}

}  // namespace

ImageIntake::ImageIntake(const FrameBuilderConfig& config, PhotometricCalibration photometric, bool in_background)
    : config_(config),
      chooses_binning_(config.binning == 0),
      photometric_(std::move(photometric)),
      in_background_(in_background),
      white_level_(config.white_level) {}

void ImageIntake::setCalibration(const CameraCalibration& calibration, const CalibrationCorrection& known) {
  next_builder_ = {};
  calibration_ = calibration;
  correction_ = start_ = known;
  if (chooses_binning_) config_.binning = binningOf(0, calibration);
  builder_ = makeBuilder(config_, correction_);
  repeats_.ignore(builder_->unused());
}

ImageIntake::Result ImageIntake::take(const CameraImage& image) {
  Result result;
  if (image.image.empty() || !builder_) {
    result.reason = builder_ || !image.problem.empty() ? image.problem : "no calibration yet";
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
  const std::uint64_t images = image.sequence > last_sequence_ ? image.sequence - last_sequence_ : 1;
  last_sequence_ = image.sequence;
  const std::int64_t stamp_ns = stamps_.smooth(image.stamp_ns, images);
  if (isRepeat(image)) {
    result.repeats = original_.sequence;
    append(result.reason,
           "repeats the image of " + std::to_string(1e-9 * static_cast<double>(original_.stamp_ns)) + " s");
    if (!isFrozen(image.stamp_ns)) return result;
  }
  adoptCorrected();
  build(image, stamp_ns - image.stamp_ns, verdict.exposure, result);
  return result;
}

bool ImageIntake::isRepeat(const CameraImage& image) {
  if (repeats_.isRepeat(image.image)) {
    ++original_.repeats;
    return true;
  }
  original_ = {image.sequence, image.stamp_ns, 0};
  return false;
}

bool ImageIntake::isFrozen(std::int64_t stamp_ns) const {
  const double seconds = 1e-9 * static_cast<double>(stamp_ns - original_.stamp_ns);
  return seconds > kLongestRepeat && original_.repeats > kFewRepeats;
}

void ImageIntake::build(const CameraImage& image, std::int64_t stamp_shift_ns, const std::optional<double>& exposure,
                        Result& result) {
  const auto begin = std::chrono::steady_clock::now();
  append(result.reason, adoptWhiteLevel(image.image));
  try {
    // Without an exposure the stamp is all that is known.
    const std::int64_t mid_exposure_ns = image.exposure && !exposure ? image.stamp_ns : image.mid_exposure_ns;
    result.frame = withGain(image, mid_exposure_ns + stamp_shift_ns, exposure);
    append(result.reason, adoptOverlay(image.image));
  } catch (const std::invalid_argument& error) {
    result.reason = error.what();
    result.contradicts_calibration = true;
    repeats_.reset();
  }
  result.build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

bool ImageIntake::correct(const CalibrationCorrection& correction) {
  if (!builder_ || correction == correction_) return false;
  correction_ = correction;
  if (in_background_) {
    prepareBuilder();
  } else {
    builder_->correct(correction);
  }
  return true;
}

std::string ImageIntake::halve() {
  if (!builder_ || !chooses_binning_ || calibration_->width < 2 * config_.binning * kLeastWidth) return "";
  config_.binning *= 2;
  prepareBuilder();
  if (!in_background_) {
    next_builder_.wait();
    adoptCorrected();
  }
  std::ostringstream text;
  text << "images are worked on at " << calibration_->width / config_.binning << "x"
       << calibration_->height / config_.binning << " from now on: they come faster than they can be tracked";
  return text.str();
}

void ImageIntake::reset() {
  guard_.reset();
  stamps_.reset();
  repeats_.reset();
  white_level_ = WhiteLevel(config_.white_level);
  gain_ = {};
  overlay_ = {};
  const bool pending = next_builder_.valid();
  next_builder_ = {};
  correction_ = start_;
  if (pending) builder_ = makeBuilder(config_, correction_);
  if (!builder_) return;
  builder_->correct(correction_);
  builder_->setOverlay({});
}

/// Making its maps takes longer than tracking an image: images go on being made as before meanwhile.
void ImageIntake::prepareBuilder() {
  next_builder_ = std::async(std::launch::async, [this, config = config_, correction = correction_] {
    return makeBuilder(config, correction);
  });
}

std::unique_ptr<FrameBuilder> ImageIntake::makeBuilder(const FrameBuilderConfig& config,
                                                       const CalibrationCorrection& correction) const {
  auto builder = std::make_unique<FrameBuilder>(*calibration_, photometric_, config);
  builder->correct(correction);
  return builder;
}

void ImageIntake::adoptCorrected() {
  if (next_builder_.valid() && next_builder_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    builder_ = next_builder_.get();
    builder_->setOverlay(overlay_.pixels());
  }
}

/// What is found later does not change the brightness of images, unless they are too bright without.
std::string ImageIntake::adoptWhiteLevel(const cv::Mat& image) {
  const double before = white_level_.found();
  const double now = white_level_.of(image);
  builder_->setWhiteLevel(now);
  if (before == 0.0 || now == before) return "";
  gain_.makeUpFor(now / before);
  std::ostringstream text;
  text << "white is " << now << ", not " << before << " as the images so far said; image.white_level tells it at once";
  return text.str();
}

std::string ImageIntake::adoptOverlay(const cv::Mat& image) {
  const bool was_free = overlay_.pixels().empty();
  const bool found =
      config_.find_overlay && overlay_.add(image, std::max(config_.white_level, white_level_.found())) && was_free;
  builder_->setOverlay(overlay_.pixels());
  repeats_.ignore(builder_->unused());
  return found ? "static overlay: " + std::to_string(1e2 * shareOf(overlay_.pixels())) + " % of the image masked" : "";
}

FrameConstPtr ImageIntake::withGain(const CameraImage& image, std::int64_t mid_exposure_ns,
                                    const std::optional<double>& exposure) {
  const auto make = [&] {
    builder_->setGain(gain_.value());
    return builder_->build(image.image, image.sequence, image.stamp_ns, mid_exposure_ns, exposure, image.depth);
  };
  FrameConstPtr frame = make();
  const double mean = meanBrightness(frame->pyramid);
  if (gain_.suits(mean)) return frame;
  const ImageLevel& finest = frame->pyramid.level(0);
  gain_.choose(mean, static_cast<double>(estimateNoise(finest.intensity)) / finest.gain);
  return gain_.value() == finest.gain ? frame : make();
}

}  // namespace mba_vo
