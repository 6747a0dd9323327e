#include "mba_vo/solver/schur_complement.h"

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "mba_vo/image/multiversion.h"

namespace mba_vo {
namespace {

constexpr int kBlock = 8;  // states of a keyframe
using BlockRow = double __attribute__((vector_size(kBlock * sizeof(double))));
using Block = Eigen::Matrix<double, kBlock, kBlock, Eigen::RowMajor>;

/// A^T B of two blocks of columns that begin at a and b, over the given rows of a matrix, all sums in registers.
MBA_VO_MULTIVERSION
void multiplyBlocks(const double* a, const double* b, const Eigen::Index* row, const Eigen::Index* end,
                    Eigen::Index stride, double* out) {
  BlockRow sums[kBlock] = {};
  for (; row != end; ++row) {
    const double* const left = a + *row * stride;
    BlockRow right;
    std::memcpy(&right, b + *row * stride, sizeof(right));
    for (int i = 0; i < kBlock; ++i) sums[i] += left[i] * right;
  }
  std::memcpy(out, sums, sizeof(sums));
}

/// Which rows of each block of columns are not zero: most keyframes see but a part of the points.
class BlockRows {
 public:
  explicit BlockRows(const LinearizedWindow::RowMatrix& V)
      : rows_(V.rows()), used_(static_cast<std::size_t>(V.size() / kBlock)), common_(static_cast<std::size_t>(rows_)) {
    auto used = used_.begin();
    for (Eigen::Index column = 0; column < V.cols(); column += kBlock) {
      for (Eigen::Index row = 0; row < rows_; ++row) {
        *used++ = (V.row(row).segment<kBlock>(column).array() != 0.0).any() ? 1 : 0;
      }
    }
  }

  /// Those of both blocks, in order.
  const std::vector<Eigen::Index>& common(Eigen::Index block_a, Eigen::Index block_b) {
    const std::uint8_t* const a = used_.data() + block_a * rows_;
    const std::uint8_t* const b = used_.data() + block_b * rows_;
    common_.resize(static_cast<std::size_t>(rows_));
    std::size_t count = 0;
    for (Eigen::Index row = 0; row < rows_; ++row) {  // without branches, which nobody could predict
      common_[count] = row;
      count += static_cast<std::size_t>(a[row] & b[row]);
    }
    common_.resize(count);
    return common_;
  }

 private:
  Eigen::Index rows_;
  std::vector<std::uint8_t> used_;  // block after block
  std::vector<Eigen::Index> common_;
};

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
  BlockRows rows(scaled_);
  Block product;
  for (Eigen::Index i = 0; i < states; i += kBlock) {
    for (Eigen::Index j = 0; j <= i; j += kBlock) {
      const std::vector<Eigen::Index>& common = rows.common(i / kBlock, j / kBlock);
      if (common.empty()) continue;
      multiplyBlocks(scaled_.data() + i, scaled_.data() + j, common.data(), common.data() + common.size(), states,
                     product.data());
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
