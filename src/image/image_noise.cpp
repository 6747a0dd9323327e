#include "mba_vo/image/image_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mba_vo/geometry/median.h"

namespace mba_vo {
namespace {

constexpr float kRounding = 0.289F;         // [grey levels], 1 / sqrt(12)
constexpr float kMedianOfNormal = 0.6745F;  // of |x|, for standard deviation 1
constexpr float kGain = 6.0F;               // root of the mask's squared sum
constexpr float kLimit = 2.0F;              // [standard deviations]
constexpr float kVarianceWithin = 0.7737F;  // of a normal distribution, within kLimit
constexpr int kSampleStep = 3;              // [px]

}  // namespace

float estimateNoise(const cv::Mat1f& image) {
  std::vector<float> values;
  values.reserve(image.total() / (kSampleStep * kSampleStep) + 1);
  for (int y = 1; y + 1 < image.rows; y += kSampleStep) {
    const float* above = image[y - 1];
    const float* row = image[y];
    const float* below = image[y + 1];
    for (int x = 1; x + 1 < image.cols; x += kSampleStep) {
      const float value = above[x - 1] - 2.0F * above[x] + above[x + 1] - 2.0F * row[x - 1] + 4.0F * row[x] -
                          2.0F * row[x + 1] + below[x - 1] - 2.0F * below[x] + below[x + 1];
      if (std::isfinite(value)) values.push_back(std::abs(value));
    }
  }
  if (values.empty()) return kRounding;
  // The median of grey levels is coarse; the mean square of what is not texture is fine.
  const float limit = kLimit * std::max(1.0F, median(values) / kMedianOfNormal);
  double sum = 0.0;
  double count = 0.0;
  for (const float value : values) {
    if (value > limit) continue;
    sum += static_cast<double>(value) * static_cast<double>(value);
    count += 1.0;
  }
  const auto sigma = static_cast<float>(std::sqrt(sum / (kVarianceWithin * count)));
  return std::max(kRounding, sigma / kGain);
}

}  // namespace mba_vo
