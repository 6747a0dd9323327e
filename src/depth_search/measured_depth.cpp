#include "mba_vo/depth_search/measured_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mba_vo {
namespace {

constexpr int kRadius = 2;            // of the surroundings [px]
constexpr double kEdge = 0.07;        // difference of inverse depths in the surroundings, relative, that is an edge ...
constexpr double kNoiseSigmas = 6.0;  // ... beyond this noise

}  // namespace

MeasuredDepth measureDepth(const cv::Mat1f& depth, const Eigen::Vector2i& pixel, const DepthSensorConfig& config) {
  const cv::Rect inside(kRadius, kRadius, depth.cols - 2 * kRadius, depth.rows - 2 * kRadius);
  if (!inside.contains({pixel.x(), pixel.y()})) return {};
  float nearest = std::numeric_limits<float>::max();
  float farthest = 0.0F;
  for (int y = pixel.y() - kRadius; y <= pixel.y() + kRadius; ++y) {
    for (int x = pixel.x() - kRadius; x <= pixel.x() + kRadius; ++x) {
      const float z = depth(y, x);
      if (!(z > 0.0F)) return {};  // NaN too
      nearest = std::min(nearest, z);
      farthest = std::max(farthest, z);
    }
  }
  if (farthest > config.max_depth) return {};
  const auto inverse = [&](int dx, int dy) { return 1.0 / static_cast<double>(depth(pixel.y() + dy, pixel.x() + dx)); };
  const double w = inverse(0, 0);
  const double noise = std::hypot(config.inverse_depth_sigma, config.relative_sigma * w);
  const double spread = 1.0 / static_cast<double>(nearest) - 1.0 / static_cast<double>(farthest);
  if (spread > kEdge * w + kNoiseSigmas * noise) return {};
  const Eigen::Vector2d slope(inverse(kRadius, 0) - inverse(-kRadius, 0), inverse(0, kRadius) - inverse(0, -kRadius));
  const double shift = config.registration_sigma * slope.norm() / (2.0 * kRadius);
  return {w, noise * noise + shift * shift};
}

}  // namespace mba_vo
