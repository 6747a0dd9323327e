#include "mba_vo/window/point_activator.h"

#include <algorithm>

namespace mba_vo {
namespace {

constexpr double kUnrefinedVariance = 1.0;  // of an inverse depth not refined yet: as good as unknown [1/m^2]
constexpr double kStarving = 0.35;          // share of the points wanted
constexpr double kHostBorder = 2.0;         // [px]

template <typename Predicate>
void eraseIf(std::vector<ImmaturePoint>& points, const Predicate& isDone) {
  points.erase(std::remove_if(points.begin(), points.end(), isDone), points.end());
}

}  // namespace

PointActivator::PointActivator(Window& window, const PinholeCamera& camera, KeyframeId newest, double distance_px)
    : window_(window),
      known_(window.points()),
      camera_(camera),
      T_newest_map_(window.T_map_keyframe(newest).inverse()),
      grid_(camera, distance_px),
      keyframes_(static_cast<int>(window.keyframes().size())) {
  for (const ReferencePoint& point : pointsSeenBy(window, known_, camera, newest)) {
    grid_.occupy(point.pixel.cast<double>());
    ++visible_;
  }
}

void PointActivator::activateFound(KeyframeId host, std::vector<ImmaturePoint>& immature) {
  std::optional<SurfaceSlopes> slopes;  // few hosts need any
  const SE3 T_newest_host = T_newest_map_ * window_.T_map_keyframe(host);
  eraseIf(immature, [&](const ImmaturePoint& point) {
    if (point.state == ImmaturePoint::State::kOutlier) return true;
    if (!isReadyToActivate(point)) return false;
    const auto seen = see(T_newest_host, point, point.inverseDepth());
    if (!seen) return true;
    if (!grid_.isFree(*seen)) return false;
    if (!slopes) slopes.emplace(camera_, pointsSeenBy(window_, known_, camera_, host));
    activate(host, point, point.inverseDepth(), *slopes, *seen);
    return true;
  });
}

bool PointActivator::isStarving(int wanted_points) const { return visible_ < kStarving * wanted_points; }

void PointActivator::activateGuessed(KeyframeId host, std::vector<ImmaturePoint>& immature) {
  const std::vector<ReferencePoint> known = pointsSeenBy(window_, known_, camera_, host);
  const NearbyDepths depths(known);
  if (!depths.known()) return;
  const SurfaceSlopes slopes(camera_, known);
  const SE3 T_newest_host = T_newest_map_ * window_.T_map_keyframe(host);
  eraseIf(immature, [&](const ImmaturePoint& point) {
    const double guess = depths.at(point.pixel.cast<double>());
    const auto seen = see(T_newest_host, point, guess);
    return seen && grid_.isFree(*seen) && activate(host, point, guess, slopes, *seen);
  });
}

std::optional<Eigen::Vector2d> PointActivator::see(const SE3& T_newest_host, const ImmaturePoint& point,
                                                   double inverse_depth) const {
  const Eigen::Vector3d in_newest = T_newest_host * (camera_.unproject(point.pixel.cast<double>()) / inverse_depth);
  if (in_newest.z() <= 0.0) return std::nullopt;
  const Eigen::Vector2d pixel = camera_.project(in_newest);
  return camera_.contains(pixel, kHostBorder) ? std::optional<Eigen::Vector2d>(pixel) : std::nullopt;
}

bool PointActivator::activate(KeyframeId host, const ImmaturePoint& point, double inverse_depth,
                              const SurfaceSlopes& slopes, const Eigen::Vector2d& in_newest) {
  const Eigen::Vector2d pixel = point.pixel.cast<double>();
  const Eigen::Vector2d slope = slopes.at(pixel, inverse_depth, kUnrefinedVariance);
  residuals_ += keyframes_ - 1;
  if (!window_.activatePoint(host, pixel, inverse_depth, slope, point.measured)) return false;
  grid_.occupy(in_newest);
  ++visible_;
  return true;
}

}  // namespace mba_vo
