#include "mba_vo/io/recorded_motion.h"

#include <cstdlib>

#include "mba_vo/trajectory/finite_difference_velocity.h"

namespace mba_vo {
namespace {

constexpr std::int64_t kSameTime = 1000;           // [ns] as files are rounded
constexpr std::int64_t kLongestGap = 150'000'000;  // [ns] between frames whose velocities tell the acceleration
constexpr std::int64_t kNearInTime = 700'000'000;  // [ns]
constexpr double kNearest = 1e-3;                  // [m]
constexpr double kBeyondBorder = 40.0;             // [px]

}  // namespace

bool RecordedMotion::areNeighbours(std::size_t i, std::size_t j) const {
  return i < exposures_.size() && j < exposures_.size() && exposures_[i].map_id == exposures_[j].map_id &&
         exposures_[j].mid_exposure_ns - exposures_[i].mid_exposure_ns < kLongestGap;
}

std::optional<FrameMotion> RecordedMotion::at(std::int64_t mid_exposure_ns) const {
  std::size_t i = 0;
  while (i < exposures_.size() && std::llabs(exposures_[i].mid_exposure_ns - mid_exposure_ns) > kSameTime) ++i;
  if (i == exposures_.size()) return std::nullopt;
  const RecordedExposure& own = exposures_[i];
  FrameMotion motion{own.map_id, own.trajectory, own.trajectory.velocity};
  motion.trajectory.acceleration.setZero();
  if (i == 0 || !areNeighbours(i - 1, i) || !areNeighbours(i, i + 1)) return motion;
  const RecordedExposure& before = exposures_[i - 1];
  const RecordedExposure& after = exposures_[i + 1];
  FiniteDifferenceVelocity motion_around;
  for (const RecordedExposure* e : {&before, &own, &after}) {
    motion_around.add(e->mid_exposure_ns, e->trajectory.T_reference_mid,
                      ObservedMotion{e->trajectory.velocity, std::nullopt});
  }
  motion.trajectory.velocity = motion_around.velocityOfMiddle();
  const double interval = 1e-9 * static_cast<double>(after.mid_exposure_ns - before.mid_exposure_ns);
  motion.trajectory.acceleration = (after.trajectory.velocity - before.trajectory.velocity) / interval;
  return motion;
}

std::vector<DepthSample> depthsInFrame(const std::vector<MapPoint>& points, const PinholeCamera& camera,
                                       const FrameMotion& motion, std::int64_t mid_exposure_ns) {
  const SE3 T_camera_map = motion.trajectory.T_reference_mid.inverse();
  std::vector<DepthSample> samples;
  for (const MapPoint& point : points) {
    if (point.map_id != motion.map_id || std::llabs(point.keyframe_ns - mid_exposure_ns) > kNearInTime) continue;
    const Eigen::Vector3d in_camera = T_camera_map * point.position_map;
    if (in_camera.z() < kNearest) continue;
    const Eigen::Vector2d pixel = camera.project(in_camera);
    if (!camera.contains(pixel, -kBeyondBorder)) continue;
    samples.push_back({pixel.cast<float>(), static_cast<float>(1.0 / in_camera.z())});
  }
  return samples;
}

}  // namespace mba_vo
