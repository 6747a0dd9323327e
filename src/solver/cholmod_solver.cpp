#include <cholmod.h>

#include <algorithm>
#include <vector>

#include "mba_vo/solver/reduced_camera_solver.h"

namespace mba_vo {
namespace {

/// Which blocks of the lower half hold anything, column by column.
std::vector<bool> blockPattern(const Eigen::MatrixXd& H, int block) {
  const Eigen::Index n = H.rows() / block;
  std::vector<bool> filled;
  for (Eigen::Index c = 0; c < n; ++c) {
    for (Eigen::Index r = c; r < n; ++r) {
      filled.push_back(r == c || !H.block(r * block, c * block, block, block).isZero(0.0));
    }
  }
  return filled;
}

}  // namespace

class CholmodSolver::Impl {
 public:
  explicit Impl(int block_size) : block_(block_size) {
    cholmod_start(&common_);
    common_.print = 0;
    common_.final_ll = 1;  // L L^T: an indefinite matrix is refused
    common_.quick_return_if_not_posdef = 1;
  }
  ~Impl() {
    clear();
    cholmod_finish(&common_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  bool solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& b, Eigen::VectorXd& x) {
    std::vector<bool> pattern = blockPattern(H, block_);
    if (factor_ == nullptr || pattern != pattern_) analyze(H, std::move(pattern));
    fillValues(H);
    if (cholmod_factorize(matrix_, factor_, &common_) == 0 || common_.status != CHOLMOD_OK) return false;
    cholmod_dense rhs = view(b);
    cholmod_dense* solution = cholmod_solve(CHOLMOD_A, factor_, &rhs, &common_);
    if (solution == nullptr) return false;
    x = Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(solution->x), b.size());
    cholmod_free_dense(&solution, &common_);
    return true;
  }

  int analyses() const { return analyses_; }

 private:
  static cholmod_dense view(const Eigen::VectorXd& b) {
    cholmod_dense dense{};
    dense.nrow = dense.nzmax = dense.d = static_cast<std::size_t>(b.size());
    dense.ncol = 1;
    dense.x = const_cast<double*>(b.data());  // CHOLMOD does not write its right-hand side
    dense.xtype = CHOLMOD_REAL;
    dense.dtype = CHOLMOD_DOUBLE;
    return dense;
  }

  /// Calls f(row, column) for every stored entry of the lower half in column-major order.
  template <typename F>
  void forEachEntry(int rows, const F& f) const {
    const int n = rows / block_;
    std::size_t column_start = 0;  // of the block column in pattern_
    for (int c = 0; c < n; ++c) {
      for (int j = c * block_; j < (c + 1) * block_; ++j) {
        for (int r = c; r < n; ++r) {
          if (!pattern_[column_start + static_cast<std::size_t>(r - c)]) continue;
          for (int i = std::max(r * block_, j); i < (r + 1) * block_; ++i) f(i, j);
        }
      }
      column_start += static_cast<std::size_t>(n - c);
    }
  }

  void analyze(const Eigen::MatrixXd& H, std::vector<bool> pattern) {
    clear();
    pattern_ = std::move(pattern);
    const int n = static_cast<int>(H.rows());
    std::size_t entries = 0;
    forEachEntry(n, [&](int, int) { ++entries; });
    const auto size = static_cast<std::size_t>(n);
    matrix_ = cholmod_allocate_sparse(size, size, entries, 1, 1, -1, CHOLMOD_REAL, &common_);
    int* columns = static_cast<int*>(matrix_->p);
    int* rows = static_cast<int*>(matrix_->i);
    std::fill(columns, columns + n + 1, 0);
    forEachEntry(n, [&](int i, int j) {
      *rows++ = i;
      ++columns[j + 1];
    });
    for (int j = 0; j < n; ++j) columns[j + 1] += columns[j];
    factor_ = cholmod_analyze(matrix_, &common_);
    ++analyses_;
  }

  void fillValues(const Eigen::MatrixXd& H) {
    double* value = static_cast<double*>(matrix_->x);
    forEachEntry(static_cast<int>(H.rows()), [&](int i, int j) { *value++ = H(i, j); });
  }

  void clear() {
    cholmod_free_factor(&factor_, &common_);
    cholmod_free_sparse(&matrix_, &common_);
  }

  int block_;
  int analyses_ = 0;
  std::vector<bool> pattern_;
  cholmod_common common_{};
  cholmod_sparse* matrix_ = nullptr;  // owned, freed through common_
  cholmod_factor* factor_ = nullptr;  // owned, freed through common_
};

CholmodSolver::CholmodSolver(int block_size) : impl_(std::make_unique<Impl>(block_size)) {}
CholmodSolver::~CholmodSolver() = default;

bool CholmodSolver::solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& b, Eigen::VectorXd& x) {
  return impl_->solve(H, b, x);
}

int CholmodSolver::analyses() const { return impl_->analyses(); }

}  // namespace mba_vo
