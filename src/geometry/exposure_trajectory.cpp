#include "mba_vo/geometry/exposure_trajectory.h"

namespace mba_vo {

Vector6 ExposureTrajectory::xi() const { return exposure * velocity; }

ExposureTrajectory ExposureTrajectory::delayed(double delay) const {
  return {at(delay), velocity + delay * acceleration, exposure, acceleration};
}

ExposureTrajectory ExposureTrajectory::fromStartAndEnd(const SE3& start, const SE3& end, double exposure) {
  const Vector6 xi = (start.inverse() * end).log();
  const Vector6 velocity = exposure > 0.0 ? Vector6(xi / exposure) : Vector6::Zero();
  return {start * SE3::exp(0.5 * xi), velocity, exposure};
}

}  // namespace mba_vo
