#include "mba_vo/solver/block_sparse_solver.h"

#include <cholmod.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace mba_vo {

class BlockSparseSolver::Impl {
 public:
  Impl(int block_size, int blocks_per_side, std::vector<Block> blocks) : size_(block_size), side_(blocks_per_side) {
    for (int i = 0; i < side_; ++i) blocks.emplace_back(i, i);
    // Column by column, as CHOLMOD stores them.
    std::sort(blocks.begin(), blocks.end(), [](const Block& l, const Block& r) {
      return std::pair(l.second, l.first) < std::pair(r.second, r.first);
    });
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    for (const auto& [row, column] : blocks) {
      if (column >= 0 && row >= column && row < side_) continue;
      throw std::invalid_argument("block (" + std::to_string(row) + ", " + std::to_string(column) +
                                  ") is not in the lower half");
    }
    blocks_ = std::move(blocks);
    cholmod_start(&common_);
    common_.print = 0;
    common_.final_ll = 1;  // L L^T: an indefinite matrix is refused
    common_.quick_return_if_not_posdef = 1;
    layOut();
  }
  ~Impl() {
    cholmod_free_factor(&factor_, &common_);
    cholmod_free_sparse(&matrix_, &common_);
    cholmod_finish(&common_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  double* values() { return static_cast<double*>(matrix_->x); }
  std::size_t valueCount() const { return matrix_->nzmax; }

  void add(int row, int column, const Eigen::Ref<const Eigen::MatrixXd>& added) {
    const auto begin = blocks_.begin() + column_begin_[static_cast<std::size_t>(column)];
    const auto end = blocks_.begin() + column_begin_[static_cast<std::size_t>(column) + 1];
    const auto place =
        std::lower_bound(begin, end, row, [](const Block& block, int wanted) { return block.first < wanted; });
    if (place == end || place->first != row) throw std::invalid_argument("the pattern has no such block");
    const int above = static_cast<int>(place - begin);
    const int* columns = static_cast<const int*>(matrix_->p);
    for (int c = 0; c < size_; ++c) {
      // The first block of a column is that on the diagonal, of which column c has size - c entries.
      const int offset = above == 0 ? 0 : size_ - c + (above - 1) * size_;
      double* to = values() + columns[column * size_ + c] + offset;
      for (int r = above == 0 ? c : 0; r < size_; ++r) *to++ += added(r, c);
    }
  }

  void scaleDiagonal(double factor) {
    const int* columns = static_cast<const int*>(matrix_->p);
    for (int c = 0; c < side_ * size_; ++c) values()[columns[c]] *= factor;
  }

  bool factorize() {
    if (factor_ == nullptr) factor_ = cholmod_analyze(matrix_, &common_);
    return cholmod_factorize(matrix_, factor_, &common_) != 0 && common_.status == CHOLMOD_OK;
  }

  Eigen::MatrixXd solve(const Eigen::MatrixXd& B) {
    cholmod_dense rhs{};
    rhs.nrow = rhs.d = static_cast<std::size_t>(B.rows());
    rhs.ncol = static_cast<std::size_t>(B.cols());
    rhs.nzmax = rhs.nrow * rhs.ncol;
    rhs.x = const_cast<double*>(B.data());  // CHOLMOD does not write its right-hand side
    rhs.xtype = CHOLMOD_REAL;
    rhs.dtype = CHOLMOD_DOUBLE;
    cholmod_dense* solution = cholmod_solve(CHOLMOD_A, factor_, &rhs, &common_);
    if (solution == nullptr) throw std::runtime_error("CHOLMOD has no memory left");
    Eigen::MatrixXd X = Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(solution->x), B.rows(), B.cols());
    cholmod_free_dense(&solution, &common_);
    return X;
  }

 private:
  /// Fills in which entries there are.
  void layOut() {
    column_begin_.assign(static_cast<std::size_t>(side_) + 1, 0);
    for (const Block& block : blocks_) ++column_begin_[static_cast<std::size_t>(block.second) + 1];
    for (std::size_t c = 0; c < static_cast<std::size_t>(side_); ++c) column_begin_[c + 1] += column_begin_[c];
    const auto n = static_cast<std::size_t>(side_ * size_);
    const std::size_t size = static_cast<std::size_t>(size_);
    const std::size_t entries = blocks_.size() * size * size - static_cast<std::size_t>(side_) * size * (size - 1) / 2;
    matrix_ = cholmod_allocate_sparse(n, n, entries, 1, 1, -1, CHOLMOD_REAL, &common_);
    if (matrix_ == nullptr) throw std::runtime_error("CHOLMOD has no memory left");
    int* columns = static_cast<int*>(matrix_->p);
    int* rows = static_cast<int*>(matrix_->i);
    int filled = 0;
    for (int column = 0; column < side_; ++column) {
      for (int c = 0; c < size_; ++c) {
        columns[column * size_ + c] = filled;
        for (int k = column_begin_[static_cast<std::size_t>(column)];
             k < column_begin_[static_cast<std::size_t>(column) + 1]; ++k) {
          const int row = blocks_[static_cast<std::size_t>(k)].first;
          for (int r = row == column ? c : 0; r < size_; ++r) rows[filled++] = row * size_ + r;
        }
      }
    }
    columns[n] = filled;
    std::fill_n(values(), valueCount(), 0.0);
  }

  int size_;                       // of a block
  int side_;                       // blocks
  std::vector<Block> blocks_;      // of the lower half, column by column
  std::vector<int> column_begin_;  // the first one of a column of blocks, in blocks_
  cholmod_common common_{};
  cholmod_sparse* matrix_ = nullptr;  // owned, freed through common_
  cholmod_factor* factor_ = nullptr;  // owned, freed through common_
};

BlockSparseSolver::BlockSparseSolver(int block_size, int blocks_per_side, std::vector<Block> blocks)
    : impl_(std::make_unique<Impl>(block_size, blocks_per_side, std::move(blocks))) {}
BlockSparseSolver::~BlockSparseSolver() = default;

void BlockSparseSolver::setZero() { std::fill_n(impl_->values(), impl_->valueCount(), 0.0); }
void BlockSparseSolver::add(int row, int column, const Eigen::Ref<const Eigen::MatrixXd>& values) {
  impl_->add(row, column, values);
}
void BlockSparseSolver::scaleDiagonal(double factor) { impl_->scaleDiagonal(factor); }
bool BlockSparseSolver::factorize() { return impl_->factorize(); }
Eigen::MatrixXd BlockSparseSolver::solve(const Eigen::MatrixXd& B) const { return impl_->solve(B); }

}  // namespace mba_vo
