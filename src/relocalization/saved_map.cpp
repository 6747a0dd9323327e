#include "mba_vo/relocalization/saved_map.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {

std::size_t SavedMap::pointCount() const {
  std::size_t count = 0;
  for (const ArchivedKeyframe& keyframe : keyframes) count += keyframe.reference.points.size();
  return count;
}

bool canBeOfOneCamera(const PinholeCamera& a, const PinholeCamera& b) {
  const auto& [small, large] = std::minmax(a, b, [](const auto& c, const auto& d) { return c.width < d.width; });
  const int binning = large.width / std::max(small.width, 1);
  return binning > 0 && small.width == large.width / binning && small.height == large.height / binning;
}

void moveBeforeAnyRun(SavedMap& map) {
  constexpr std::int64_t kLongestGap = 60'000'000'000;  // [ns]
  std::int64_t next = 0, moved = kBeforeAnyRun;
  for (auto keyframe = map.keyframes.rbegin(); keyframe != map.keyframes.rend(); ++keyframe) {
    std::int64_t& ns = keyframe->reference.mid_exposure_ns;
    if (keyframe != map.keyframes.rbegin()) moved -= std::clamp<std::int64_t>(next - ns, 0, kLongestGap);
    next = ns;
    ns = moved;
  }
}

void place(ArchivedKeyframe& keyframe, const Sim3& S_map_keyframe) {
  Reference& reference = keyframe.reference;
  const double scale = S_map_keyframe.scale();
  reference.T_map_reference = S_map_keyframe.rigid();
  reference.image_xi.head<3>() *= scale;
  reference.motion.velocity.head<3>() *= scale;
  reference.motion.acceleration.head<3>() *= scale;
  for (ReferencePoint& point : reference.points) {
    point.inverse_depth = static_cast<float>(point.inverse_depth / scale);
    point.variance = static_cast<float>(point.variance / (scale * scale));
  }
}

void keepUnit(std::vector<Sim3>& poses) {
  const Eigen::Vector3d origin = poses.front().translation();
  const double unit = 1.0 / poses.front().scale();
  for (Sim3& S : poses) {
    S = Sim3(SE3(S.rotation(), origin + unit * (S.translation() - origin)), unit * S.scale());
  }
}

std::vector<MapPoint> displayPoints(const SavedMap& saved, MapId map, std::size_t most) {
  std::vector<MapPoint> points;
  if (most == 0) return points;
  const std::size_t step = saved.pointCount() / most + 1;
  std::size_t next = 0;
  for (const ArchivedKeyframe& keyframe : saved.keyframes) {
    const Reference& reference = keyframe.reference;
    for (const ReferencePoint& point : reference.points) {
      if (next++ % step != 0) continue;
      const Eigen::Vector3d in_keyframe =
          keyframe.camera.unproject(point.pixel.cast<double>()) / static_cast<double>(point.inverse_depth);
      const auto x = static_cast<int>(std::lround(point.pixel.x()));
      const auto y = static_cast<int>(std::lround(point.pixel.y()));
      points.push_back({reference.T_map_reference * in_keyframe, static_cast<float>(keyframe.image(y, x)),
                        reference.id.keyframe_id, reference.mid_exposure_ns, map});
    }
  }
  return points;
}

}  // namespace mba_vo
