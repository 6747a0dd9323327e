#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "depth_search/textured_wall_scene.h"
#include "mba_vo/depth_search/depth_search.h"

namespace mba_vo::test {

inline void searchDepth(const ImagePyramid& host, const ImagePyramid& frame, const ExposureTrajectory& T_host,
                        double gain, double offset, const DepthSearchConfig& config, ImmaturePoint& point) {
  DepthSearcher(host, frame, T_host, gain, offset, config).search(point);
}

/// How well found depths agree with the scene, seen from the origin.
struct DepthStatistics {
  int good = 0;               // points with an upper bound of their inverse depth and quality
  double accurate = 0.0;      // fraction of the good ones within the tolerance
  double contained = 0.0;     // fraction of the good ones whose interval contains the truth
  double median_error = 0.0;  // relative
};

inline DepthStatistics evaluateDepths(const PlaneScene& scene, const std::vector<ImmaturePoint>& points,
                                      double tolerance) {
  DepthStatistics result;
  std::vector<double> errors;
  for (const ImmaturePoint& point : points) {
    if (!point.hasDepth() || point.state == ImmaturePoint::State::kOutlier || point.quality < 3.0) continue;
    const double truth = scene.inverseDepth(SE3(), point.pixel.cast<double>());
    errors.push_back(std::abs(point.inverseDepth() / truth - 1.0));
    result.accurate += errors.back() < tolerance;
    result.contained += point.inverse_depth_min <= truth && truth <= point.inverse_depth_max;
  }
  if (errors.empty()) return result;
  const auto n = static_cast<double>(errors.size());
  result.good = static_cast<int>(errors.size());
  result.accurate /= n;
  result.contained /= n;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  result.median_error = *middle;
  return result;
}

}  // namespace mba_vo::test
