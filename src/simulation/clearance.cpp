#include "mba_vo/simulation/clearance.h"

#include <algorithm>

namespace mba_vo {

double distanceTo(const Surface& surface, const Eigen::Vector3d& point) {
  const Eigen::Vector3d offset = point - surface.origin;
  const double u = std::clamp(offset.dot(surface.axis_u), 0.0, surface.length_u);
  const double v = std::clamp(offset.dot(surface.axis_v), 0.0, surface.length_v);
  return (offset - u * surface.axis_u - v * surface.axis_v).norm();
}

Clearance::Clearance(std::vector<Eigen::Vector3d> path, double distance) : path_(std::move(path)), distance_(distance) {
  constexpr std::size_t kLength = 64;  // points of a stretch: about half a metre
  for (std::size_t begin = 0; begin < path_.size(); begin += kLength) {
    const std::size_t end = std::min(begin + kLength, path_.size());
    const Eigen::Vector3d center = path_[(begin + end) / 2];
    double radius = 0.0;
    for (std::size_t i = begin; i < end; ++i) radius = std::max(radius, (path_[i] - center).norm());
    stretches_.push_back({begin, end, center, radius});
  }
}

bool Clearance::violatedBy(const Surface& surface) const {
  for (const Stretch& stretch : stretches_) {
    if (distanceTo(surface, stretch.center) >= distance_ + stretch.radius) continue;
    for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
      if (distanceTo(surface, path_[i]) < distance_) return true;
    }
  }
  return false;
}

}  // namespace mba_vo
