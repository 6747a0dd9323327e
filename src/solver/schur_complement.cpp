#include "mba_vo/solver/schur_complement.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "mba_vo/image/multiversion.h"
#include "mba_vo/image/parallel_for.h"

namespace mba_vo {
namespace {

constexpr int kBlock = 8;  // states of a keyframe
using BlockRow = double __attribute__((vector_size(kBlock * sizeof(double))));
using Block = Eigen::Matrix<double, kBlock, kBlock, Eigen::RowMajor>;

constexpr Eigen::Index kRows = 128;  // of V at a time: with 30 keyframes they fit the second cache

/// A^T W B of two blocks of columns that begin at a and b, over the given rows of a matrix, all sums in registers.
MBA_VO_MULTIVERSION
void multiplyBlocks(const double* a, const double* b, const double* weights, const std::vector<Eigen::Index>& rows,
                    Eigen::Index stride, double* out) {
  BlockRow sums[kBlock] = {};
  for (const Eigen::Index row : rows) {
    const double* const left = a + row * stride;
    BlockRow right;
    std::memcpy(&right, b + row * stride, sizeof(right));
    right *= weights[row];
    for (int i = 0; i < kBlock; ++i) sums[i] += left[i] * right;
  }
  std::memcpy(out, sums, sizeof(sums));
}

/// Which of some rows are not zero in each block of columns: most keyframes see but a part of the points.
class BlockRows {
 public:
  BlockRows(const LinearizedWindow::RowMatrix& V, Eigen::Index begin, Eigen::Index end)
      : begin_(begin), rows_(end - begin), used_(static_cast<std::size_t>(rows_ * V.cols() / kBlock)) {
    for (Eigen::Index row = 0; row < rows_; ++row) {
      for (Eigen::Index block = 0; block < V.cols() / kBlock; ++block) {
        const auto entries = V.row(begin + row).segment<kBlock>(kBlock * block).array();
        used_[static_cast<std::size_t>(block * rows_ + row)] = (entries != 0.0).any() ? 1 : 0;
      }
    }
  }

  /// Those of both blocks, in order.
  void findCommon(Eigen::Index block_a, Eigen::Index block_b, std::vector<Eigen::Index>& common) const {
    const std::uint8_t* const a = used_.data() + block_a * rows_;
    const std::uint8_t* const b = used_.data() + block_b * rows_;
    common.resize(static_cast<std::size_t>(rows_));
    std::size_t count = 0;
    for (Eigen::Index row = 0; row < rows_; ++row) {  // without branches, which nobody could predict
      common[count] = begin_ + row;
      count += static_cast<std::size_t>(a[row] & b[row]);
    }
    common.resize(count);
  }

 private:
  Eigen::Index begin_;
  Eigen::Index rows_;
  std::vector<std::uint8_t> used_;  // block after block
};

std::vector<BlockRows> findBlockRows(const LinearizedWindow::RowMatrix& V) {
  std::vector<BlockRows> found;
  for (Eigen::Index begin = 0; begin < V.rows(); begin += kRows) {
    found.emplace_back(V, begin, std::min(begin + kRows, V.rows()));
  }
  return found;
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
  const Eigen::Index states = system.V.cols();
  if (states % kBlock != 0) throw std::invalid_argument("schur complement: states of a keyframe are missing");
  const double* const V = system.V.data();
  const std::vector<BlockRows> rows = findBlockRows(system.V);
  const Eigen::Index blocks = states / kBlock;
  // Each row of blocks on a thread, the longest first.
  parallelFor(static_cast<std::size_t>(blocks), [&](std::size_t task) {
    const Eigen::Index i = blocks - 1 - static_cast<Eigen::Index>(task);
    std::vector<Eigen::Index> common;
    Block product;
    for (const BlockRows& some : rows) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        some.findCommon(i, j, common);
        if (common.empty()) continue;
        multiplyBlocks(V + kBlock * i, V + kBlock * j, inverse_H_depth_.data(), common, states, product.data());
        reduced.H.block<kBlock, kBlock>(kBlock * i, kBlock * j) -= product;
        if (i != j) reduced.H.block<kBlock, kBlock>(kBlock * j, kBlock * i) -= product.transpose();
      }
    }
  });
  reduced.b = system.b - system.V.transpose() * inverse_H_depth_.cwiseProduct(system.b_depth);
}

Eigen::VectorXd SchurComplement::solveDepths(const LinearizedWindow& system, const Eigen::VectorXd& step) const {
  return -inverse_H_depth_.cwiseProduct(system.b_depth + system.V * step);
}

}  // namespace mba_vo
