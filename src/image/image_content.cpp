#include "mba_vo/image/image_content.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

constexpr int kRadius = 4;              // [px] of the squares
constexpr int kSmallWidth = 100;        // [px] most of a small version
constexpr double kLeastGradient = 1.0;  // [grey levels / px] there, several times what noise leaves
constexpr double kLeastShare = 0.02;    // of its pixels

const ImageLevel& smallVersion(const ImagePyramid& pyramid) {
  int level = 0;
  while (level + 1 < pyramid.levels() && pyramid.level(level).intensity.cols > kSmallWidth) ++level;
  return pyramid.level(level);
}

double squaredGradient(const cv::Mat1f& image, int x, int y) {  // NaN where a neighbour is invalid
  const double dx = 0.5 * static_cast<double>(image(y, x + 1) - image(y, x - 1));
  const double dy = 0.5 * static_cast<double>(image(y + 1, x) - image(y - 1, x));
  return dx * dx + dy * dy;
}

}  // namespace

double rmsGradient(const ImageLevel& level, const std::vector<Eigen::Vector2d>& centres) {
  const cv::Mat1f& image = level.intensity;
  double sum = 0.0;
  int count = 0;
  for (const Eigen::Vector2d& centre : centres) {
    if (!centre.allFinite() || !level.camera.contains(centre)) continue;
    const auto cx = static_cast<int>(std::lround(centre.x()));
    const auto cy = static_cast<int>(std::lround(centre.y()));
    for (int y = std::max(1, cy - kRadius); y <= std::min(image.rows - 2, cy + kRadius); ++y) {
      for (int x = std::max(1, cx - kRadius); x <= std::min(image.cols - 2, cx + kRadius); ++x) {
        const double square = squaredGradient(image, x, y);
        if (!std::isfinite(square)) continue;
        sum += square;
        ++count;
      }
    }
  }
  return count > 0 ? std::sqrt(0.5 * sum / count) : 0.0;
}

bool hasContent(const ImagePyramid& pyramid) {
  if (pyramid.levels() < 1) return false;
  const cv::Mat1f& image = smallVersion(pyramid).intensity;
  const double least = kLeastGradient * smallVersion(pyramid).gain;  // the noise has it too
  int steep = 0;
  int valid = 0;
  for (int y = 1; y + 1 < image.rows; ++y) {
    for (int x = 1; x + 1 < image.cols; ++x) {
      const double square = squaredGradient(image, x, y);
      if (!std::isfinite(square)) continue;
      ++valid;
      if (square > least * least) ++steep;
    }
  }
  return valid > 0 && steep > kLeastShare * valid;
}

double meanBrightness(const ImagePyramid& pyramid) {
  if (pyramid.levels() < 1) return 0.0;
  const ImageLevel& level = smallVersion(pyramid);
  double sum = 0.0;
  double count = 0.0;
  for (const float pixel : level.intensity) {
    if (!std::isfinite(pixel)) continue;
    sum += static_cast<double>(pixel);
    count += 1.0;
  }
  return count > 0.0 ? sum / (count * level.gain) : 0.0;
}

double contrast(const ImagePyramid& pyramid) {
  if (pyramid.levels() < 1) return 0.0;
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (const float pixel : smallVersion(pyramid).intensity) {
    const auto value = static_cast<double>(pixel);
    if (!std::isfinite(value)) continue;
    sum += value;
    squares += value * value;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(std::max(0.0, squares / count - sum * sum / (count * count))) : 0.0;
}

}  // namespace mba_vo
