#include "mba_vo/image/image_pyramid.h"

#include <stdexcept>
#include <string>

namespace mba_vo {
namespace {

constexpr int kSmallestSide = 16;  // [px]

cv::Mat1f halve(const cv::Mat1f& fine) {
  cv::Mat1f coarse(fine.rows / 2, fine.cols / 2);
  for (int y = 0; y < coarse.rows; ++y) {
    const float* upper = fine[2 * y];
    const float* lower = fine[2 * y + 1];
    float* out = coarse[y];
    for (int x = 0; x < coarse.cols; ++x) {
      out[x] = 0.25F * (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1]);
    }
  }
  return coarse;
}

}  // namespace

ImagePyramid::ImagePyramid(const cv::Mat1f& intensity, const PinholeCamera& camera, int levels, double gain) {
  if (levels < 1) {
    throw std::invalid_argument("image pyramid: levels is " + std::to_string(levels) + ", must be at least 1");
  }
  if (intensity.cols != camera.width || intensity.rows != camera.height) {
    throw std::invalid_argument("image pyramid: image is " + std::to_string(intensity.cols) + "x" +
                                std::to_string(intensity.rows) + ", camera is " + std::to_string(camera.width) + "x" +
                                std::to_string(camera.height));
  }
  levels_.push_back({intensity, camera, gain});
  while (static_cast<int>(levels_.size()) < levels) {
    const ImageLevel& fine = levels_.back();
    const PinholeCamera half = fine.camera.halved();
    if (half.width < kSmallestSide || half.height < kSmallestSide) break;
    levels_.push_back({halve(fine.intensity), half, gain});
  }
}

void ImagePyramid::correctCamera(const CalibrationCorrection& lacking) {
  for (ImageLevel& level : levels_) level.camera = withCorrection(level.camera, lacking);
}

std::size_t ImagePyramid::bytes() const {
  std::size_t total = 0;
  for (const ImageLevel& level : levels_) total += level.intensity.total() * level.intensity.elemSize();
  return total;
}

}  // namespace mba_vo
