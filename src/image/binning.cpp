#include "mba_vo/image/binning.h"

#include <cstdint>

#include <opencv2/imgproc.hpp>

namespace mba_vo {
namespace {

// Between the largest camera that was measured with, 960x540, and 1280x720, which has 2.6 times the pixels of 752x480.
constexpr std::int64_t kMostPixels = 600000;

cv::Mat1f resized(const cv::Mat1f& image, int binning, int interpolation) {
  if (binning == 1) return image;
  const cv::Size size(image.cols / binning, image.rows / binning);
  cv::Mat1f result;
  cv::resize(image(cv::Rect(cv::Point(), size * binning)), result, size, 0.0, 0.0, interpolation);
  return result;
}

/// Pixel centres are at integers.
double binnedCentre(double centre, int binning) { return (centre + 0.5) / binning - 0.5; }

}  // namespace

int binningOf(int configured, const CameraCalibration& calibration) {
  if (configured > 0) return configured;
  return std::int64_t{calibration.width} * calibration.height > kMostPixels ? 2 : 1;
}

CameraCalibration binned(const CameraCalibration& calibration, int binning) {
  CameraCalibration result = calibration;
  result.width /= binning;
  result.height /= binning;
  result.fx /= binning;
  result.fy /= binning;
  result.cx = binnedCentre(calibration.cx, binning);
  result.cy = binnedCentre(calibration.cy, binning);
  return result;
}

cv::Mat1f binned(const cv::Mat1f& image, int binning) { return resized(image, binning, cv::INTER_AREA); }

cv::Mat1f binnedDepth(const cv::Mat1f& depth, int binning) { return resized(depth, binning, cv::INTER_NEAREST); }

}  // namespace mba_vo
