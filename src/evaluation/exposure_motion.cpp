#include "mba_vo/evaluation/exposure_motion.h"

#include <algorithm>
#include <cmath>

#include "mba_vo/geometry/angles.h"
#include "mba_vo/geometry/pinhole_camera.h"

namespace mba_vo {
namespace {

constexpr int kColumns = 16;
constexpr int kRows = 10;
constexpr double kDepth = 2.0;  // [m]
const PinholeCamera kCamera{752, 480, 430.0, 430.0, 375.5, 239.5};

using FlowField = Eigen::Matrix<double, 2, kColumns * kRows>;  // [px]

/// Displacements of points that are 2 m away at mid-exposure.
FlowField flowField(const ExposurePoses& poses, double scale) {
  const SE3 motion = poses.T_world_start.inverse() * poses.T_world_end;
  const SE3 T_start_end(motion.rotation(), scale * motion.translation());
  const SE3 T_start_mid = SE3::exp(0.5 * T_start_end.log());
  const SE3 T_end_mid = T_start_end.inverse() * T_start_mid;
  FlowField field;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const int column = i % kColumns;
    const int row = i / kColumns;
    const Eigen::Vector2d pixel((column + 0.5) * kCamera.width / kColumns - 0.5,
                                (row + 0.5) * kCamera.height / kRows - 0.5);
    const Eigen::Vector3d point = kDepth * kCamera.unproject(pixel);
    field.col(i) = kCamera.project(T_end_mid * point) - kCamera.project(T_start_mid * point);
  }
  return field;
}

}  // namespace

std::optional<ExposureMotionError> compareExposureMotion(const ExposurePoses& groundtruth,
                                                         const ExposurePoses& estimate, double scale, double min_blur) {
  const FlowField truth = flowField(groundtruth, 1.0);
  const FlowField estimated = flowField(estimate, scale);
  ExposureMotionError error;
  error.blur_px = truth.colwise().norm().mean();
  if (error.blur_px < min_blur || error.blur_px == 0.0) {
    return std::nullopt;
  }
  error.length_ratio = estimated.norm() / truth.norm();
  const double product = estimated.norm() * truth.norm();
  // An estimate without any motion has no direction: as wrong as one at right angles.
  const double cosine = product > 0.0 ? estimated.cwiseProduct(truth).sum() / product : 0.0;
  error.direction = kDegreesPerRadian * std::acos(std::clamp(cosine, -1.0, 1.0));
  return error;
}

}  // namespace mba_vo
