#pragma once

#include "mba_vo/evaluation/pose_file.h"

namespace mba_vo {

/// Exposure about `mid` with a body motion xi from start to end.
inline ExposurePoses exposureAbout(const SE3& mid, const Vector6& xi) {
  return {0.02, mid * SE3::exp(-0.5 * xi), mid * SE3::exp(0.5 * xi)};
}

inline Vector6 twist(double x, double y, double z, double rx, double ry, double rz) {
  return (Vector6() << x, y, z, rx, ry, rz).finished();
}

}  // namespace mba_vo
