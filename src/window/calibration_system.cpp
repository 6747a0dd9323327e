#include "mba_vo/window/calibration_system.h"

#include <Eigen/Cholesky>

namespace mba_vo {
namespace {

constexpr int kDim = CalibrationCorrection::kDim;
constexpr int kBlock = 2 * kKeyframeDim;  // the correction's states, filled up to keyframes'
constexpr double kDamping = 1e-6;         // relative; settles position, direction and scale
constexpr double kFirstKeyframe = 1e6;    // relative information of the first keyframe, which holds the map
constexpr double kLeastDiagonal = 1e-9;   // keeps states without any information solvable

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

/// Normal equations of one host in one target: the target's states and the correction.
struct PairSystem {
  Matrix8 H_target = Matrix8::Zero();
  Eigen::Matrix<double, kKeyframeDim, kDim> H_mixed = Eigen::Matrix<double, kKeyframeDim, kDim>::Zero();
  CalibrationCorrection::Matrix H_correction = CalibrationCorrection::Matrix::Zero();
  Vector8 b_target = Vector8::Zero();
  CalibrationCorrection::Vector b_correction = CalibrationCorrection::Vector::Zero();
};

/// What one residual adds to a point.
struct DepthTerms {
  Vector8 target;
  CalibrationCorrection::Vector correction;
  double H;
  double b;
};

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

DepthTerms addResidual(const Eigen::Matrix<double, 7, 7>& S, const MomentMatrix& E, PairSystem& sums) {
  const Eigen::Matrix<double, kMoments, kPath> SE = S.topLeftCorner<kMoments, kMoments>() * E;
  const Eigen::Matrix<double, kPath, kPath> H = E.transpose() * SE;
  const Eigen::Matrix<double, 3, kPath> R = S.bottomLeftCorner<3, kMoments>() * E;  // J_a, J_b and r with the path
  sums.H_target.topLeftCorner<6, 6>() += H.topLeftCorner<6, 6>();
  sums.H_target.bottomLeftCorner<2, 6>() += R.topLeftCorner<2, 6>();
  sums.H_target.topRightCorner<6, 2>() += R.topLeftCorner<2, 6>().transpose();
  sums.H_target.bottomRightCorner<2, 2>() += S.block<2, 2>(4, 4);
  sums.H_mixed.topRows<6>() += H.topRightCorner<6, kDim>();
  sums.H_mixed.bottomRows<2>() += R.topRightCorner<2, kDim>();
  sums.H_correction += H.bottomRightCorner<kDim, kDim>();
  sums.b_target.head<6>() += R.row(2).head<6>().transpose();
  sums.b_target.tail<2>() += S.block<2, 1>(4, 6);
  sums.b_correction += R.row(2).tail<kDim>().transpose();
  DepthTerms depth;
  depth.target << H.block<6, 1>(0, 6), R.block<2, 1>(0, 6);
  depth.correction = H.block<kDim, 1>(7, 6);
  depth.H = H(6, 6);
  depth.b = R(2, 6);
  return depth;
}

/// J_host of makePairGeometry at the current state instead of the first estimates.
Matrix8 currentHostJacobian(const PairGeometry& pair) {
  Matrix8 J = pair.J_host;
  J.topLeftCorner<6, 6>() = -pair.T_target_host.adjoint();
  return J;
}

/// Adds what one pair knows; the correction's states follow those of the keyframes.
void addPair(const PairSystem& pair, const Matrix8& J_host, int host, int target, LinearizedWindow& out) {
  const int h = kKeyframeDim * host;
  const int t = kKeyframeDim * target;
  const int c = static_cast<int>(out.b.size()) - kBlock;
  const Matrix8 H_host_target = J_host.transpose() * pair.H_target;
  const Eigen::Matrix<double, kKeyframeDim, kDim> H_host_mixed = J_host.transpose() * pair.H_mixed;
  out.H.block<kKeyframeDim, kKeyframeDim>(t, t) += pair.H_target;
  out.H.block<kKeyframeDim, kKeyframeDim>(h, h) += H_host_target * J_host;
  out.H.block<kKeyframeDim, kKeyframeDim>(h, t) += H_host_target;
  out.H.block<kKeyframeDim, kKeyframeDim>(t, h) += H_host_target.transpose();
  out.H.block<kKeyframeDim, kDim>(t, c) += pair.H_mixed;
  out.H.block<kKeyframeDim, kDim>(h, c) += H_host_mixed;
  out.H.block<kDim, kDim>(c, c) += pair.H_correction;
  out.b.segment<kKeyframeDim>(t) += pair.b_target;
  out.b.segment<kKeyframeDim>(h) += J_host.transpose() * pair.b_target;
  out.b.segment<kDim>(c) += pair.b_correction;
}

/// All residuals of the evaluation, at the current state.
LinearizedWindow assemble(const WindowState& state, const WindowEvaluation& evaluation) {
  const int n = state.size();
  const std::vector<PairGeometry>& pairs = evaluation.pairs;
  LinearizedWindow out;
  out.setZero(kKeyframeDim * n + kBlock, static_cast<int>(evaluation.points.size()));
  std::vector<PairSystem> sums(pairs.size());
  PatchPath path;
  for (std::size_t row = 0; row < evaluation.points.size(); ++row) {
    const auto i = static_cast<Eigen::Index>(row);
    const PointState& point = state.points[static_cast<std::size_t>(evaluation.points[row])];
    std::size_t patch = evaluation.first[row];
    for (const PatchResidual& residual : point.residuals) {
      const PatchComparison& comparison = evaluation.patches[patch++];
      if (!(residual.trial_energy <= state.keyframe(residual.target).outlier_energy)) continue;
      const auto index = static_cast<std::size_t>(point.host * n + residual.target);
      const PairGeometry& pair = pairs[index];
      const Eigen::Vector2d pixel = residual.centre.cast<double>();
      if (!makeCurrentJacobianPath(pair, residual.centre, point, path)) continue;
      const DepthTerms depth = addResidual(productSums(comparison, pair.blurred),
                                           pathJacobian(pair, path, pixel, point.pixel.y()), sums[index]);
      out.V.row(i).segment<kKeyframeDim>(kKeyframeDim * residual.target) += depth.target.transpose();
      out.V.row(i).segment<kKeyframeDim>(kKeyframeDim * point.host) +=
          depth.target.transpose() * currentHostJacobian(pair);
      out.V.row(i).segment<kDim>(kKeyframeDim * n) += depth.correction.transpose();
      out.H_depth(i) += depth.H;
      out.b_depth(i) += depth.b;
    }
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const int host = static_cast<int>(i) / n;
    const int target = static_cast<int>(i) % n;
    if (pairs[i].path) addPair(sums[i], currentHostJacobian(pairs[i]), host, target, out);
  }
  return out;
}

/// Eliminates the keyframes' states too.
CalibrationSystem eliminateKeyframes(const ReducedSystem& reduced) {
  const Eigen::Index n = reduced.b.size() - kBlock;
  Eigen::MatrixXd H = reduced.H.topLeftCorner(n, n);
  H.diagonal() *= 1.0 + kDamping;
  H.topLeftCorner<kKeyframeDim, kKeyframeDim>().diagonal() *= kFirstKeyframe;
  const Eigen::VectorXd scale = H.diagonal().cwiseMax(kLeastDiagonal).cwiseSqrt().cwiseInverse();
  H = scale.asDiagonal() * H * scale.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> factors(H);
  // Above the diagonal, where the correction's columns are filled.
  const Eigen::MatrixXd mixed = scale.asDiagonal() * reduced.H.block(0, n, n, kDim);
  const Eigen::VectorXd b = scale.asDiagonal() * reduced.b.head(n);
  CalibrationSystem out;
  out.H = reduced.H.block<kDim, kDim>(n, n) - mixed.transpose() * factors.solve(mixed);
  out.b = reduced.b.segment<kDim>(n) - mixed.transpose() * factors.solve(b);
  return out;
}

}  // namespace

std::array<Matrix2C, 2> calibrationJacobian(const PairGeometry& pair, const PatchPath& path,
                                            const Eigen::Vector2d& pixel, double host_row) {
  const PinholeCamera& host = pair.host_camera;
  const PinholeCamera& target = pair.target_camera;
  const Matrix2C at_target = lensJacobian(target, pixel);
  const auto rowsFromMiddle = [](const PinholeCamera& camera, double row) { return row - 0.5 * (camera.height - 1); };
  // As an increment of the target's pose, like J_pose.
  const Vector6 by_row = rowsFromMiddle(target, pixel.y()) * pair.rows.camera -
                         rowsFromMiddle(host, host_row) * (pair.T_target_host.adjoint() * pair.rows.reference);
  std::array<Matrix2C, 2> J{lensJacobian(host, path.c0.cast<double>()) - path.A0.cast<double>() * at_target,
                            -path.A1.cast<double>() * at_target};
  for (std::size_t i = 0; i < 2; ++i) J[i].col(CalibrationCorrection::kRowTime) = path.J_pose[i] * by_row;
  return J;
}

CalibrationSystem linearizeCalibration(WindowState& state, const WindowLinearizer& linearizer, int stride) {
  std::vector<int> chosen;
  for (int i = 0; i < static_cast<int>(state.points.size()); i += stride) chosen.push_back(i);
  WindowEvaluation evaluation;
  linearizer.evaluate(state, chosen, evaluation);
  const LinearizedWindow system = assemble(state, evaluation);
  ReducedSystem reduced;
  SchurComplement().reduce(system, 0.0, reduced);
  return eliminateKeyframes(reduced);
}

}  // namespace mba_vo
