#include "mba_vo/solver/marginalization_prior.h"

#include <Eigen/Eigenvalues>

namespace mba_vo {
namespace {

constexpr double kMinRelativeEigenvalue = 1e-13;  // of the scaled block; below it a direction counts as unobserved

/// Pseudo-inverse of a positive semi-definite block whose diagonal was scaled to one.
Matrix8 pseudoInverse(const Matrix8& H) {
  const Eigen::SelfAdjointEigenSolver<Matrix8> eigen(H);
  const double smallest = kMinRelativeEigenvalue * std::max(eigen.eigenvalues().maxCoeff(), 0.0);
  const Vector8 inverse = (eigen.eigenvalues().array() > smallest).select(eigen.eigenvalues().cwiseInverse(), 0.0);
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

/// 1 / sqrt(diagonal), 1 where there is no information.
Eigen::VectorXd scaling(const Eigen::MatrixXd& H) {
  return (H.diagonal().array() > 0.0).select(H.diagonal().array().max(1e-300).rsqrt(), 1.0);
}

}  // namespace

void MarginalizationPrior::appendKeyframe() {
  const Eigen::Index n = b_.size();
  H_.conservativeResizeLike(Eigen::MatrixXd::Zero(n + kKeyframeDim, n + kKeyframeDim));
  b_.conservativeResizeLike(Eigen::VectorXd::Zero(n + kKeyframeDim));
  coupling_.conservativeResizeLike(CalibrationCoupling::Zero(n + kKeyframeDim, CalibrationCorrection::kDim));
  connected_.push_back(false);
}

void MarginalizationPrior::add(const Eigen::MatrixXd& H, const Eigen::VectorXd& b) {
  H_ += 0.5 * (H + H.transpose());
  b_ += b;
}

void MarginalizationPrior::addDiagonal(int keyframe, const Vector8& information, const Vector8& deviation) {
  const int at = kKeyframeDim * keyframe;
  H_.diagonal().segment<kKeyframeDim>(at) += information;
  b_.segment<kKeyframeDim>(at) += information.cwiseProduct(deviation);
}

void MarginalizationPrior::moveLinearizationPoint(int keyframe, const Vector8& step) {
  // (d + s)^T H (d + s) + 2 b^T (d + s) = d^T H d + 2 (b + H s)^T d + (H s + 2 b)^T s
  const Eigen::VectorXd H_step = H_.middleCols<kKeyframeDim>(kKeyframeDim * keyframe) * step;
  constant_ += (H_step + 2.0 * b_).segment<kKeyframeDim>(kKeyframeDim * keyframe).dot(step);
  b_ += H_step;
}

double MarginalizationPrior::cost(const Eigen::VectorXd& d) const {
  return d.dot(H_ * d) + 2.0 * b_.dot(d) + constant_;
}

void MarginalizationPrior::addTo(const Eigen::VectorXd& d, Eigen::MatrixXd& H, Eigen::VectorXd& b) const {
  H += H_;
  b += b_ + H_ * d;
}

void MarginalizationPrior::marginalize(int keyframe) {
  const Eigen::Index n = b_.size();
  const Eigen::Index at = kKeyframeDim * keyframe;
  const Eigen::Index kept = n - kKeyframeDim;
  const Eigen::VectorXd scale = scaling(H_);
  const Eigen::MatrixXd H = scale.asDiagonal() * H_ * scale.asDiagonal();
  const Eigen::VectorXd b = scale.asDiagonal() * b_;

  Eigen::VectorXi rows(kept);
  for (Eigen::Index i = 0; i < kept; ++i) rows(i) = static_cast<int>(i < at ? i : i + kKeyframeDim);
  const Eigen::MatrixXd H_kept_out = H(rows, Eigen::seqN(at, kKeyframeDim));
  const Eigen::MatrixXd gain = H_kept_out * pseudoInverse(H.block<kKeyframeDim, kKeyframeDim>(at, at));
  Eigen::MatrixXd H_new = H(rows, rows) - gain * H_kept_out.transpose();
  const Eigen::VectorXd b_new = b(rows) - gain * b.segment<kKeyframeDim>(at);
  const CalibrationCoupling coupling = scale.asDiagonal() * coupling_;
  const CalibrationCoupling coupling_new = coupling(rows, Eigen::all) - gain * coupling.middleRows<kKeyframeDim>(at);

  for (int k = 0; k < keyframes(); ++k) {
    if (H_.block<6, kKeyframeDim>(kKeyframeDim * k, at).squaredNorm() > 0.0) connect(k);
  }
  const Eigen::VectorXd unscale = scale(rows).cwiseInverse();
  H_new = (unscale.asDiagonal() * H_new * unscale.asDiagonal()).eval();
  H_ = 0.5 * (H_new + H_new.transpose());
  b_ = unscale.asDiagonal() * b_new;
  coupling_ = unscale.asDiagonal() * coupling_new;
  connected_.erase(connected_.begin() + keyframe);
}

}  // namespace mba_vo
