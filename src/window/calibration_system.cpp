#include "mba_vo/window/calibration_system.h"

namespace mba_vo {
namespace {

constexpr int kDim = CalibrationCorrection::kDim;
using Matrix2C = Eigen::Matrix<double, 2, kDim>;
constexpr int kPath = 6 + 1 + kDim;  // what moves and brightens the path: pose, inverse depth, correction
constexpr int kMoments = 6;          // of the gradient, the derivative by the brightness a, and none

/// Of the path and the brightness.
void fillJacobian(const PairGeometry& pair, const PatchPath& path, const Eigen::Vector2d& pixel, double host_row,
                  MomentProducts<kPath>& products) {
  const std::array<Matrix2C, 2> correction = calibrationJacobian(pair, path, pixel, host_row);
  for (std::size_t i = 0; i < 2; ++i) {
    products.E.middleRows<2>(2 * static_cast<int>(i)) << path.J_pose[i], path.J_inverse_depth[i], correction[i];
  }
  products.E.block<1, CalibrationCorrection::kVignetteDim>(4, kPath - CalibrationCorrection::kVignetteDim) =
      (vignetteJacobian(pair.target_camera, pixel) - vignetteJacobian(pair.host_camera, path.c0.cast<double>()))
          .transpose();
}

}  // namespace

CalibrationResidual assembleCalibration(const PairGeometry& pair, const PatchComparison& comparison,
                                        const PatchPath& path, const Eigen::Vector2d& pixel, double host_row) {
  MomentProducts<kPath> products;
  fillJacobian(pair, path, pixel, host_row, products);
  const SparsePixels none{};
  const PatchComparison& c = comparison;
  multiplyOut(c.weight,
              {&c.gx, &c.gy, pair.blurred ? &c.ugx : &none, pair.blurred ? &c.ugy : &none, &c.J_a, &none, &c.r,
               &kJacobianOfOffset},
              kMoments, kPath, products);
  const auto& S = products.S;
  const auto& H = products.ESE;
  const auto a = products.SE.row(4);  // with the path, like r and b
  const auto r = products.SE.row(6);
  const auto b = products.SE.row(7);
  CalibrationResidual out;
  out.H << H.topLeftCorner<6, 6>(), a.head<6>().transpose(), b.head<6>().transpose(),  //
      a.head<6>(), S(4, 4), S(4, 7), b.head<6>(), S(7, 4), S(7, 7);
  out.b << r.head<6>().transpose(), S(4, 6), S(7, 6);
  out.H_state_correction << H.topRightCorner<6, kDim>(), a.tail<kDim>(), b.tail<kDim>();
  out.correction.H = H.bottomRightCorner<kDim, kDim>();
  out.correction.b = r.tail<kDim>().transpose();
  out.H_state_depth << H.block<6, 1>(0, 6), a(6), b(6);
  out.H_correction_depth = H.block<kDim, 1>(7, 6);
  out.H_depth = H(6, 6);
  out.b_depth = r(6);
  return out;
}

std::array<Matrix2C, 2> calibrationJacobian(const PairGeometry& pair, const PatchPath& path,
                                            const Eigen::Vector2d& pixel, double host_row) {
  const PinholeCamera& host = pair.host_camera;
  const PinholeCamera& target = pair.target_camera;
  const Matrix2C at_target = lensJacobian(target, pixel);
  const auto fromMiddle = [](const PinholeCamera& camera, double row) {  // [heights of the image]
    return (row - 0.5 * (camera.height - 1)) / camera.height;
  };
  // As an increment of the target's pose, like J_pose.
  const Vector6 by_readout = fromMiddle(target, pixel.y()) * pair.rows.camera.velocity -
                             fromMiddle(host, host_row) * (pair.T_target_host.adjoint() * pair.rows.reference.velocity);
  std::array<Matrix2C, 2> J{lensJacobian(host, path.c0.cast<double>()) - path.A0.cast<double>() * at_target,
                            -path.A1.cast<double>() * at_target};
  for (std::size_t i = 0; i < 2; ++i) J[i].col(CalibrationCorrection::kReadout) = path.J_pose[i] * by_readout;
  return J;
}

}  // namespace mba_vo
