#include "mba_vo/window/schur_complement.h"

#include <cstring>
#include <stdexcept>

#include "mba_vo/blur/multiversion.h"

namespace mba_vo {
namespace {

constexpr int kBlock = 8;  // states of a keyframe
using BlockRow = double __attribute__((vector_size(kBlock * sizeof(double))));
using Block = Eigen::Matrix<double, kBlock, kBlock, Eigen::RowMajor>;

/// A^T B of two blocks of columns, row after row, all sums in registers.
MBA_VO_MULTIVERSION
void multiplyBlocks(const double* a, const double* b, Eigen::Index rows, Eigen::Index stride, double* out) {
  BlockRow sums[kBlock] = {};
  for (Eigen::Index row = 0; row < rows; ++row, a += stride, b += stride) {
    BlockRow right;
    std::memcpy(&right, b, sizeof(right));
    for (int i = 0; i < kBlock; ++i) sums[i] += a[i] * right;
  }
  std::memcpy(out, sums, sizeof(sums));
}

}  // namespace

void LinearizedWindow::setZero(int states, int points) {
  H.setZero(states, states);
  b.setZero(states);
  V.setZero(points, states);
  H_depth.setZero(points);
  b_depth.setZero(points);
}

void SchurComplement::reduce(const LinearizedWindow& system, double lambda, ReducedSystem& reduced) {
  inverse_H_depth_ = (system.H_depth.array() > 0.0).select(((1.0 + lambda) * system.H_depth.array()).inverse(), 0.0);
  reduced.H = system.H;
  reduced.H.diagonal() *= 1.0 + lambda;
  scaled_ = inverse_H_depth_.cwiseSqrt().asDiagonal() * system.V;
  const Eigen::Index states = scaled_.cols();
  if (states % kBlock != 0) throw std::invalid_argument("schur complement: states of a keyframe are missing");
  Block product;
  for (Eigen::Index i = 0; i < states; i += kBlock) {
    for (Eigen::Index j = 0; j <= i; j += kBlock) {
      multiplyBlocks(scaled_.data() + i, scaled_.data() + j, scaled_.rows(), states, product.data());
      reduced.H.block<kBlock, kBlock>(i, j) -= product;
      if (i != j) reduced.H.block<kBlock, kBlock>(j, i) -= product.transpose();
    }
  }
  reduced.b = system.b - system.V.transpose() * inverse_H_depth_.cwiseProduct(system.b_depth);
}

Eigen::VectorXd SchurComplement::solveDepths(const LinearizedWindow& system, const Eigen::VectorXd& step) const {
  return -inverse_H_depth_.cwiseProduct(system.b_depth + system.V * step);
}

}  // namespace mba_vo
