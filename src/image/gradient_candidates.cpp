#include "gradient_candidates.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace mba_vo {
namespace {

constexpr int kBins = 256;
constexpr float kBinsPerUnit = 4.0F;  // [px / grey level]

float medianOfRegion(const cv::Mat1f& magnitude, const cv::Mat1b& allowed, cv::Rect region) {
  std::array<int, kBins> histogram{};
  int total = 0;
  for (int y = region.y; y < region.y + region.height; ++y) {
    const float* const m = magnitude[y];
    const std::uint8_t* const ok = allowed[y];
    for (int x = region.x; x < region.x + region.width; ++x) {
      if (ok[x] == 0) continue;
      ++histogram[static_cast<std::size_t>(std::min(static_cast<int>(kBinsPerUnit * m[x]), kBins - 1))];
      ++total;
    }
  }
  int below = 0;
  for (std::size_t i = 0; i < kBins; ++i) {
    below += histogram[i];
    if (2 * below > total) return (static_cast<float>(i) + 0.5F) / kBinsPerUnit;
  }
  return 0.0F;
}

}  // namespace

GradientImage computeGradients(const cv::Mat1f& image) {
  GradientImage result{cv::Mat1f(image.size(), 0.0F), cv::Mat1f(image.size(), 0.0F), cv::Mat1f(image.size(), 0.0F)};
  for (int y = 1; y + 1 < image.rows; ++y) {
    const float* const above = image[y - 1];
    const float* const here = image[y];
    const float* const below = image[y + 1];
    float* const gx = result.gx[y];
    float* const gy = result.gy[y];
    float* const magnitude = result.magnitude[y];
    for (int x = 1; x + 1 < image.cols; ++x) {
      gx[x] = 0.5F * (here[x + 1] - here[x - 1]);
      gy[x] = 0.5F * (below[x] - above[x]);
      magnitude[x] = std::sqrt(gx[x] * gx[x] + gy[x] * gy[x]);
    }
  }
  return result;
}

cv::Mat1b makeAllowedMask(const cv::Mat1f& image, int border) {
  const int margin = std::max(border, 1);  // central differences need a neighbour
  cv::Mat1b allowed(image.size(), std::uint8_t{0});
  if (image.cols <= 2 * margin || image.rows <= 2 * margin) return allowed;
  const cv::Rect inner(margin, margin, image.cols - 2 * margin, image.rows - 2 * margin);
  cv::Mat1b valid;
  cv::compare(image, image, valid, cv::CMP_EQ);  // false for NaN
  if (cv::countNonZero(valid) < image.rows * image.cols) {
    cv::erode(valid, valid, cv::getStructuringElement(cv::MORPH_RECT, {2 * margin + 1, 2 * margin + 1}));
  }
  valid(inner).copyTo(allowed(inner));
  return allowed;
}

RegionMedians::RegionMedians(const cv::Mat1f& magnitude, const cv::Mat1b& allowed) {
  const cv::Rect image(0, 0, magnitude.cols, magnitude.rows);
  cv::Mat1f medians((magnitude.rows - 1) / kSide + 1, (magnitude.cols - 1) / kSide + 1);
  for (int y = 0; y < medians.rows; ++y) {
    for (int x = 0; x < medians.cols; ++x) {
      medians(y, x) = medianOfRegion(magnitude, allowed, cv::Rect(x * kSide, y * kSide, kSide, kSide) & image);
    }
  }
  cv::blur(medians, smoothed_, {3, 3}, {-1, -1}, cv::BORDER_REPLICATE);
}

std::vector<GradientCandidate> findCandidates(const GradientImage& gradients, int level, const cv::Mat1b& allowed,
                                              const RegionMedians& medians, float margin) {
  std::vector<GradientCandidate> candidates;
  const int step = 1 << level;
  for (int y = 1; y + 1 < gradients.magnitude.rows; ++y) {
    const int y0 = y * step;
    const std::uint8_t* const ok = allowed[y0];
    const float* const magnitude = gradients.magnitude[y];
    const float* const median = medians.row(y0);
    for (int x = 1; x + 1 < gradients.magnitude.cols; ++x) {
      const int x0 = x * step;
      if (!(magnitude[x] > margin) || ok[x0] == 0) continue;  // medians are not negative
      if (magnitude[x] > median[x0 / RegionMedians::kSide] + margin) {
        candidates.push_back({x0, y0, gradients.gx(y, x), gradients.gy(y, x)});
      }
    }
  }
  return candidates;
}

}  // namespace mba_vo
