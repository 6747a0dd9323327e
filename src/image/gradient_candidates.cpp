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
  std::array<std::array<int, kBins>, 2>
      histograms{};  // by turns: neighbours often share a bin, which would have to wait
  int total = 0;
  for (int y = region.y; y < region.y + region.height; ++y) {
    const float* const m = magnitude[y];
    const std::uint8_t* const ok = allowed[y];
    for (int x = region.x; x < region.x + region.width; ++x) {
      if (ok[x] == 0) continue;
      auto& histogram = histograms[static_cast<std::size_t>(x & 1)];
      ++histogram[static_cast<std::size_t>(std::min(static_cast<int>(kBinsPerUnit * m[x]), kBins - 1))];
      ++total;
    }
  }
  int below = 0;
  for (std::size_t i = 0; i < kBins; ++i) {
    below += histograms[0][i] + histograms[1][i];
    if (2 * below > total) return (static_cast<float>(i) + 0.5F) / kBinsPerUnit;
  }
  return 0.0F;
}

}  // namespace

cv::Mat1f gradientMagnitude(const cv::Mat1f& image) {
  cv::Mat1f result(image.size());
  for (int y = 0; y < image.rows; ++y) {
    float* const magnitude = result[y];
    if (y == 0 || y + 1 == image.rows || image.cols < 3) {
      std::fill_n(magnitude, image.cols, 0.0F);
      continue;
    }
    const float* const above = image[y - 1];
    const float* const here = image[y];
    const float* const below = image[y + 1];
    magnitude[0] = magnitude[image.cols - 1] = 0.0F;
    for (int x = 1; x + 1 < image.cols; ++x) {
      const float gx = 0.5F * (here[x + 1] - here[x - 1]);
      const float gy = 0.5F * (below[x] - above[x]);
      magnitude[x] = std::sqrt(gx * gx + gy * gy);
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

std::vector<GradientCandidate> findCandidates(const cv::Mat1f& image, const cv::Mat1f& magnitude, int level,
                                              const cv::Mat1b& allowed, const RegionMedians& medians, float margin) {
  std::vector<GradientCandidate> candidates;
  std::vector<int> columns(static_cast<std::size_t>(image.cols));
  for (int y = 1; y + 1 < image.rows; ++y) {
    const int y0 = y << level;
    const std::uint8_t* const ok = allowed[y0];
    const float* const m = magnitude[y];
    const float* const median = medians.row(y0);
    std::size_t count = 0;
    for (int x = 1; x + 1 < image.cols; ++x) {  // without branches, which nobody could predict
      const int x0 = x << level;
      columns[count] = x;
      count += static_cast<std::size_t>(m[x] > median[x0 / RegionMedians::kSide] + margin) & (ok[x0] & 1U);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const int x = columns[i];
      candidates.push_back(
          {x << level, y0, 0.5F * (image(y, x + 1) - image(y, x - 1)), 0.5F * (image(y + 1, x) - image(y - 1, x))});
    }
  }
  return candidates;
}

}  // namespace mba_vo
