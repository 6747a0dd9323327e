#include "mba_vo/image/frame_builder.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "mba_vo/image/binning.h"
#include "mba_vo/image/rectifier.h"
#include "mba_vo/image/saturation.h"
#include "mba_vo/image/static_overlay.h"

namespace mba_vo {
namespace {

// Share of saturated pixels from which on they are masked. Lamps and windows are fewer, are white in all images alike,
// and their edges tell more than is lost (desk: 1.6 %, at most 4.5 %).
constexpr double kOverexposed = 0.05;

// Share of the image. Where it was 11 %, filling its hole for the initialiser took the errors of three starts of shake
// from 24, 4 and 355 mm to 1.4, 1.1 and 4.9; with the letters of phone, 0.4 %, a fifth fewer images were tracked.
constexpr double kLargeMask = 0.02;

/// What rectified images are to be multiplied with; empty if the correction knows of no vignette.
cv::Mat1f inverseVignette(const PinholeCamera& camera, const CalibrationCorrection& correction) {
  if (!correction.correctsVignette()) return {};
  cv::Mat1f inverse(camera.height, camera.width);
  for (int y = 0; y < inverse.rows; ++y) {
    for (int x = 0; x < inverse.cols; ++x) {
      const double log_light = correction.vignette().dot(vignetteJacobian(camera, {x, y}));
      inverse(y, x) = static_cast<float>(std::exp(-log_light));
    }
  }
  return inverse;
}

std::string sizeOf(const cv::Mat& image) { return std::to_string(image.cols) + "x" + std::to_string(image.rows); }

/// 255 where the mask says that a pixel is not used; empty if there is none.
cv::Mat1b unusedPixels(const PhotometricCalibration& photometric, const FrameBuilderConfig& config, cv::Size size) {
  const cv::Mat1b& mask = photometric.mask;
  if (mask.empty()) return {};
  if (mask.size() != size) {
    throw std::invalid_argument(config.mask_file + ": the mask is " + sizeOf(mask) + ", the camera calibration says " +
                                std::to_string(size.width) + "x" + std::to_string(size.height));
  }
  return cv::Mat1b(mask == 0);
}

}  // namespace

class FrameBuilder::Impl {
 public:
  Impl(const CameraCalibration& calibration, const PhotometricCalibration& photometric,
       const FrameBuilderConfig& config)
      : size_(calibration.width, calibration.height),
        binning_(binningOf(config.binning, calibration)),
        binned_(binned(calibration, binning_)),
        rectifier_(binned_),
        correction_(photometric, config.gamma, size_),
        masked_(unusedPixels(photometric, config, size_)),
        unused_(masked_),
        levels_(config.pyramid_levels),
        camera_(rectifier_.camera()),
        row_time_(binning_ * config.row_time) {
    camera_.row_time = row_time_;
    if (levels_ < 1) {
      throw std::invalid_argument("pyramid_levels is " + std::to_string(levels_) + ", must be at least 1");
    }
  }

  const PinholeCamera& camera() const { return camera_; }
  const CalibrationCorrection& correction() const { return calibration_correction_; }
  const cv::Mat1b& unused() const { return unused_; }

  void correct(const CalibrationCorrection& correction) {
    if (correction == calibration_correction_) return;
    if (correction.values.head<CalibrationCorrection::kReadout>() !=
        calibration_correction_.values.head<CalibrationCorrection::kReadout>()) {
      rectifier_ = Rectifier(binned_, correction);
    }
    calibration_correction_ = correction;
    inverse_vignette_ = inverseVignette(camera_, correction);
    camera_.row_time = row_time_ + correction[CalibrationCorrection::kReadout] / camera_.height;
  }

  void setWhiteLevel(double white_level) { white_level_ = white_level; }
  void setGain(double gain) { gain_ = gain; }

  const cv::Mat1b& overlay() const { return overlay_; }
  void setOverlay(const cv::Mat1b& overlay) {
    if (overlay.data == overlay_.data) return;
    overlay_ = overlay;
    unused_ = masked_.empty() ? overlay_ : overlay_.empty() ? masked_ : cv::Mat1b(masked_ | overlay_);
  }

  ImagePyramid makePyramid(const cv::Mat& image) const {
    requireSize("image", image);
    cv::Mat1f seen = correction_.apply(image, white_level_);
    if (!unused_.empty()) seen.setTo(std::numeric_limits<float>::quiet_NaN(), unused_);
    cv::Mat1f light = rectifier_.rectify(binned(seen, binning_));
    if (!inverse_vignette_.empty()) light = light.mul(inverse_vignette_);
    if (gain_ != 1.0) light *= gain_;
    ImagePyramid pyramid(light, camera(), levels_, gain_);
    maskSaturated(image, light);
    return pyramid;
  }

  cv::Mat1f makeDepth(const cv::Mat1f& depth) const {
    if (depth.empty()) return {};
    requireSize("depth image", depth);
    return rectifier_.rectifyDepth(binnedDepth(depth, binning_));
  }

 private:
  /// `finest`: level. Coarser ones are to find the way, and see too little without the pixels that are bright.
  void maskSaturated(const cv::Mat& image, cv::Mat1f& finest) const {
    cv::Mat1b saturated = saturatedPixels(image, white_level_);
    if (!unused_.empty()) saturated.setTo(0, unused_);
    if (cv::countNonZero(saturated) < kOverexposed * static_cast<double>(saturated.total())) return;
    cv::Mat1f unknown(image.size(), 0.0F);
    unknown.setTo(std::numeric_limits<float>::quiet_NaN(), saturated);
    finest += rectifier_.rectify(binned(unknown, binning_));
  }

  void requireSize(const char* what, const cv::Mat& image) const {
    if (image.size() == size_) return;
    throw std::invalid_argument(std::string(what) + " is " + sizeOf(image) + ", the camera calibration says " +
                                std::to_string(size_.width) + "x" + std::to_string(size_.height));
  }

  cv::Size size_;  // of the camera's images
  int binning_;
  CameraCalibration binned_;
  Rectifier rectifier_;
  PhotometricCorrection correction_;
  cv::Mat1b masked_;                       // 255 where the mask says that pixels are not used; empty = nowhere
  cv::Mat1b overlay_;                      // 255 where something covers the scene; empty = nowhere
  cv::Mat1b unused_;                       // both
  double white_level_ = kSixteenBitWhite;  // [digital numbers]
  double gain_ = 1.0;
  int levels_;
  PinholeCamera camera_;
  double row_time_;  // as configured, of binned rows [s]
  CalibrationCorrection calibration_correction_;
  cv::Mat1f inverse_vignette_;  // of the correction; empty = none
};

FrameBuilder::FrameBuilder(const CameraCalibration& calibration, const PhotometricCalibration& photometric,
                           const FrameBuilderConfig& config)
    : impl_(std::make_unique<Impl>(calibration, photometric, config)) {}
FrameBuilder::~FrameBuilder() = default;
FrameBuilder::FrameBuilder(FrameBuilder&&) noexcept = default;

const PinholeCamera& FrameBuilder::camera() const { return impl_->camera(); }

const cv::Mat1b& FrameBuilder::unused() const { return impl_->unused(); }

void FrameBuilder::setWhiteLevel(double white_level) { impl_->setWhiteLevel(white_level); }

void FrameBuilder::setGain(double gain) { impl_->setGain(gain); }

void FrameBuilder::setOverlay(const cv::Mat1b& overlay) { impl_->setOverlay(overlay); }

void FrameBuilder::correct(const CalibrationCorrection& correction) { impl_->correct(correction); }

FrameConstPtr FrameBuilder::build(const cv::Mat& image, std::uint64_t sequence, std::int64_t stamp_ns,
                                  std::int64_t mid_exposure_ns, std::optional<double> exposure,
                                  const cv::Mat1f& depth) const {
  auto frame = std::make_shared<Frame>();
  frame->sequence = sequence;
  frame->stamp_ns = stamp_ns;
  frame->mid_exposure_ns = mid_exposure_ns;
  frame->exposure = exposure;
  frame->correction = impl_->correction();
  frame->overlay = impl_->overlay();
  frame->masked = shareOf(impl_->unused()) > kLargeMask;
  frame->pyramid = impl_->makePyramid(image);
  frame->depth = impl_->makeDepth(depth);
  return frame;
}

}  // namespace mba_vo
