#include "mba_vo/geometry/exposure_trajectory.h"

namespace mba_vo {

ExposureTrajectory ExposureTrajectory::fromStartAndEnd(const SE3& start, const SE3& end, double exposure) {
  const Vector6 xi = (start.inverse() * end).log();
  const Vector6 velocity = exposure > 0.0 ? Vector6(xi / exposure) : Vector6::Zero();
  return {start * SE3::exp(0.5 * xi), velocity, exposure};
}

}  // namespace mba_vo
