#include "mba_vo/image/depth_image.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace mba_vo {

cv::Mat1f depthInMetres(const cv::Mat& image, double units_per_metre) {
  if (image.type() != CV_16UC1 && image.type() != CV_32FC1) {
    throw std::invalid_argument("depth image is of type " + cv::typeToString(image.type()) +
                                "; allowed: 16UC1 (16 bit, one channel), 32FC1 (metres)");
  }
  cv::Mat1f depth;
  image.convertTo(depth, CV_32F, image.type() == CV_16UC1 ? 1.0 / units_per_metre : 1.0);
  for (float& z : depth) {
    if (!(z > 0.0F) || std::isinf(z)) z = std::numeric_limits<float>::quiet_NaN();
  }
  return depth;
}

}  // namespace mba_vo
