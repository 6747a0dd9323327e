#include "mba_vo/window/calibration_system.h"

namespace mba_vo {
namespace {

constexpr int kDim = CalibrationCorrection::kDim;
using Matrix2C = Eigen::Matrix<double, 2, kDim>;
constexpr int kPath = 6 + 1 + kDim;  // what moves and brightens the path: pose, inverse depth, correction
constexpr int kMoments = 5;          // of the gradient, and the derivative by the brightness a
using MomentMatrix = Eigen::Matrix<double, kMoments, kPath>;

/// Weighted sums over the pixels of the products of z = [gx gy ugx ugy J_a J_b r].
Eigen::Matrix<double, 7, 7> productSums(const PatchComparison& c, bool blurred) {
  Eigen::Matrix<double, 7, kResidualPixels> z;
  for (int k = 0; k < kResidualPixels; ++k) {
    const auto i = static_cast<std::size_t>(k);
    z.col(k) << c.gx[i], c.gy[i], blurred ? c.ugx[i] : 0.0F, blurred ? c.ugy[i] : 0.0F, -c.normalized[i], -1.0F, c.r[i];
    z.col(k) *= std::sqrt(c.weight[i]);
  }
  return z * z.transpose();
}

MomentMatrix pathJacobian(const PairGeometry& pair, const PatchPath& path, const Eigen::Vector2d& pixel,
                          double host_row) {
  const std::array<Matrix2C, 2> correction = calibrationJacobian(pair, path, pixel, host_row);
  MomentMatrix E = MomentMatrix::Zero();
  for (std::size_t i = 0; i < 2; ++i) {
    E.middleRows<2>(2 * static_cast<int>(i)) << path.J_pose[i], path.J_inverse_depth[i], correction[i];
  }
  E.bottomRightCorner<1, CalibrationCorrection::kVignetteDim>() =
      (vignetteJacobian(pair.target_camera, pixel) - vignetteJacobian(pair.host_camera, path.c0.cast<double>()))
          .transpose();
  return E;
}

}  // namespace

CalibrationResidual assembleCalibration(const PairGeometry& pair, const PatchComparison& comparison,
                                        const PatchPath& path, const Eigen::Vector2d& pixel, double host_row) {
  const Eigen::Matrix<double, 7, 7> S = productSums(comparison, pair.blurred);
  const MomentMatrix E = pathJacobian(pair, path, pixel, host_row);
  const Eigen::Matrix<double, kMoments, kPath> SE = S.topLeftCorner<kMoments, kMoments>() * E;
  const Eigen::Matrix<double, kPath, kPath> H = E.transpose() * SE;
  const Eigen::Matrix<double, 3, kPath> R = S.bottomLeftCorner<3, kMoments>() * E;  // J_a, J_b and r with the path
  CalibrationResidual out;
  out.H << H.topLeftCorner<6, 6>(), R.topLeftCorner<2, 6>().transpose(), R.topLeftCorner<2, 6>(), S.block<2, 2>(4, 4);
  out.b << R.row(2).head<6>().transpose(), S.block<2, 1>(4, 6);
  out.H_state_correction << H.topRightCorner<6, kDim>(), R.topRightCorner<2, kDim>();
  out.correction.H = H.bottomRightCorner<kDim, kDim>();
  out.correction.b = R.row(2).tail<kDim>().transpose();
  out.H_state_depth << H.block<6, 1>(0, 6), R.block<2, 1>(0, 6);
  out.H_correction_depth = H.block<kDim, 1>(7, 6);
  out.H_depth = H(6, 6);
  out.b_depth = R(2, 6);
  return out;
}

std::array<Matrix2C, 2> calibrationJacobian(const PairGeometry& pair, const PatchPath& path,
                                            const Eigen::Vector2d& pixel, double host_row) {
  const PinholeCamera& host = pair.host_camera;
  const PinholeCamera& target = pair.target_camera;
  const Matrix2C at_target = lensJacobian(target, pixel);
  const auto rowsFromMiddle = [](const PinholeCamera& camera, double row) { return row - 0.5 * (camera.height - 1); };
  // As an increment of the target's pose, like J_pose.
  const Vector6 by_row = rowsFromMiddle(target, pixel.y()) * pair.rows.camera.velocity -
                         rowsFromMiddle(host, host_row) * (pair.T_target_host.adjoint() * pair.rows.reference.velocity);
  std::array<Matrix2C, 2> J{lensJacobian(host, path.c0.cast<double>()) - path.A0.cast<double>() * at_target,
                            -path.A1.cast<double>() * at_target};
  for (std::size_t i = 0; i < 2; ++i) J[i].col(CalibrationCorrection::kRowTime) = path.J_pose[i] * by_row;
  return J;
}

}  // namespace mba_vo
