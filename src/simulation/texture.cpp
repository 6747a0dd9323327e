#include "mba_vo/simulation/texture.h"

#include <stdexcept>

#include <opencv2/imgproc.hpp>

namespace mba_vo {

Texture::Texture(const cv::Mat1f& image) : last_level_(0) {
  if (image.rows != image.cols || image.cols < 1 || (image.cols & (image.cols - 1)) != 0) {
    throw std::invalid_argument("texture: the image must be square with a side that is a power of two, got " +
                                std::to_string(image.cols) + "x" + std::to_string(image.rows));
  }
  int shift = 0;
  while ((1 << shift) < image.cols) ++shift;
  last_level_ = shift;
  cv::Mat1f level = image;
  for (int i = 0; i <= last_level_; ++i, --shift) {
    const float scale = 1.0F / static_cast<float>(1 << i);
    levels_.push_back({texels_.size(), shift, (1 << shift) - 1, scale, 0.5F * scale - 0.5F});
    cv::Mat quantised;
    level.convertTo(quantised, CV_16U, 65535.0);
    texels_.insert(texels_.end(), quantised.begin<std::uint16_t>(), quantised.end<std::uint16_t>());
    if (shift > 0) {
      cv::Mat1f half;
      cv::resize(level, half, cv::Size(level.cols / 2, level.rows / 2), 0, 0, cv::INTER_AREA);
      level = half;
    }
  }
}

}  // namespace mba_vo
