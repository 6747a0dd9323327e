#include "mba_vo/mapping/patch_match.h"

#include <cmath>

namespace mba_vo {
namespace {

struct Sample {
  float value, gx, gy;
};

/// Bilinear interpolation and its derivative.
Sample sampleAt(const float* data, std::ptrdiff_t stride, float x, float y) {
  const auto ix = static_cast<int>(x);
  const auto iy = static_cast<int>(y);
  const float wx = x - static_cast<float>(ix);
  const float wy = y - static_cast<float>(iy);
  const float* const p = data + iy * stride + ix;
  const float upper = p[1] - p[0];
  const float lower = p[stride + 1] - p[stride];
  const float top = p[0] + wx * upper;
  const float gy = p[stride] + wx * lower - top;
  return {top + wy * gy, upper + wy * (lower - upper), gy};
}

}  // namespace

float patchEnergy(const cv::Mat1f& image, const SearchPatch& patch, const Eigen::Vector2d& centre, float threshold) {
  const Eigen::Vector2f c = centre.cast<float>();
  const auto stride = static_cast<std::ptrdiff_t>(image.step1());
  const float* const data = image[0];
  float energy = 0.0F;
  for (std::size_t k = 0; k < SearchPatch::kSize; ++k) {
    const float value = sampleAt(data, stride, c.x() + patch.dx[k], c.y() + patch.dy[k]).value;
    const float r = std::abs(value - patch.value[k]);
    energy += r <= threshold ? r * r : threshold * (2.0F * r - threshold);
  }
  return energy;
}

LineStep linearise(const cv::Mat1f& image, const SearchPatch& patch, const Eigen::Vector2d& centre,
                   const Eigen::Vector2d& direction, double threshold) {
  const Eigen::Vector2f c = centre.cast<float>();
  const auto stride = static_cast<std::ptrdiff_t>(image.step1());
  LineStep sum;
  for (std::size_t k = 0; k < SearchPatch::kSize; ++k) {
    const Sample sample = sampleAt(image[0], stride, c.x() + patch.dx[k], c.y() + patch.dy[k]);
    const double residual = static_cast<double>(sample.value) - static_cast<double>(patch.value[k]);
    const double weight = std::abs(residual) <= threshold ? 1.0 : threshold / std::abs(residual);
    const double along = sample.gx * direction.x() + sample.gy * direction.y();
    const double across = sample.gy * direction.x() - sample.gx * direction.y();
    sum.hessian += weight * along * along;
    sum.gradient += weight * along * residual;
    sum.along += along * along;
    sum.mixed += along * across;
  }
  return sum;
}

double matchError(const LineStep& step, double line_error_px) {
  return line_error_px * (1.0 + std::abs(step.mixed) / step.along) + kMatchNoise / std::sqrt(step.along);
}

}  // namespace mba_vo
