#include "mba_vo/tracking/quadratic_model.h"

#include "mba_vo/image/multiversion.h"

namespace mba_vo {
namespace {

constexpr int kColumns = QuadraticModel::kColumns;
constexpr int kPose = 0;  // first column of each group of states
constexpr int kXi = 6;
constexpr int kGain = 12;
constexpr int kOffset = 13;
constexpr int kBend = 14;
constexpr int kBendStates = 3;
constexpr int kLogExposure = 17;
constexpr int kColumnsWithoutBend = 16;

/// Residual = B - (e^a Bhat + b): minus its derivative is the moments of the pixel times these. J_pose belongs to the
/// moments gx..ugy, J_xi to ugx..uugy (J_xi_row to gx, gy), all times the gain; the gain itself for a, one for b.
struct MomentJacobian {
  alignas(64) double rows[kMoments][kColumns] = {};
};

/// What turns by xi at u + row does by (u + row)^2 / 2 with the bend, to the second order in u.
template <typename Put>
void putBend(const PatchPath& path, const Put& put) {
  const auto turn = [](const Matrix26& J) { return J.rightCols<kBendStates>(); };
  const double row = path.row;
  put(0, kBend, (0.5 * row * turn(path.J_xi_row)).eval());
  put(2, kBend, (row * turn(path.J_xi[0]) - 0.5 * row * row * turn(path.J_xi[1])).eval());
  put(4, kBend, (0.5 * (turn(path.J_xi[0]) + row * turn(path.J_xi[1]))).eval());
}

MomentJacobian jacobianOf(const PatchPath& path, double gain, bool moving, bool rolling) {
  MomentJacobian J;
  const auto put = [&](int row, int column, const auto& block) {
    for (int axis = 0; axis < 2; ++axis) {
      for (int i = 0; i < block.cols(); ++i) J.rows[row + axis][column + i] = gain * block(axis, i);
    }
  };
  put(0, kPose, path.J_pose[0]);
  if (moving) {
    put(2, kPose, path.J_pose[1]);
    put(2, kXi, path.J_xi[0]);
    put(4, kXi, path.J_xi[1]);
    put(0, kXi, path.J_xi_row);  // zero with a global shutter
  }
  if (rolling) {
    putBend(path, put);
    put(2, kLogExposure, path.c1.cast<double>());  // u grows with the exposure
    put(4, kLogExposure, 2.0 * path.c2.cast<double>());
  }
  J.rows[6][kGain] = gain;
  J.rows[7][kOffset] = 1.0;
  return J;
}

/// out.hessian += J^T M J, gradient = -J^T r, out.gradient += gradient, inlined into each of the versions below. The
/// loops over columns are the ones to be vectorised; unrolled, the compiler would shuffle.
template <bool Moving, bool Rolling>
[[gnu::always_inline]] inline void addProducts(const double* __restrict moments, const double* __restrict residuals,
                                               const MomentJacobian& J, double* __restrict gradient,
                                               QuadraticModel::Arrays& __restrict out) {
  constexpr int kWidth = Rolling ? kColumns : kColumnsWithoutBend;
  constexpr int kRows = Moving ? kMoments : 4;  // without motion, the moments in u are zero
  const auto moment = [](int row) { return Moving || row < 2 ? row : row + 4; };
  alignas(64) double MJ[kMoments][kColumns];
  for (int i = 0; i < kRows; ++i) {
    const double* __restrict m = moments + moment(i) * kMoments;
#pragma GCC unroll 1
    for (int k = 0; k < kWidth; ++k) {
      double sum = 0.0;
#pragma GCC unroll 8
      for (int j = 0; j < kRows; ++j) sum += m[moment(j)] * J.rows[moment(j)][k];
      MJ[moment(i)][k] = sum;
    }
  }
#pragma GCC unroll 1
  for (int k = 0; k < kWidth; ++k) {
    double sum = 0.0;
#pragma GCC unroll 8
    for (int j = 0; j < kRows; ++j) sum += residuals[moment(j)] * J.rows[moment(j)][k];
    gradient[k] = -sum;
  }
#pragma GCC unroll 1
  for (int k = 0; k < kWidth; ++k) out.gradient[k] += gradient[k];
  // Only the rows of J where a group of states is not zero.
  constexpr int kDepth = Rolling ? 6 : (Moving ? 4 : 2);
  const auto addRow = [&](int state, int first) {
#pragma GCC unroll 1
    for (int k = 0; k < kWidth; ++k) {
      double sum = 0.0;
#pragma GCC unroll 6
      for (int j = 0; j < kDepth; ++j) sum += J.rows[first + j][state] * MJ[first + j][k];
      out.hessian[state][k] += sum;
    }
  };
  for (int state = 0; state < (Moving ? kGain : kXi); ++state) {
    addRow(state, state < kXi || Rolling ? 0 : 2);
  }
  for (int state = kBend; Rolling && state <= kLogExposure; ++state) addRow(state, 0);
#pragma GCC unroll 1
  for (int k = 0; k < kWidth; ++k) {
    out.hessian[kGain][k] += J.rows[6][kGain] * MJ[6][k];
    out.hessian[kOffset][k] += MJ[7][k];
  }
}

MBA_VO_MULTIVERSION
void addMoving(const double* __restrict moments, const double* __restrict residuals, const MomentJacobian& J,
               double* __restrict gradient, QuadraticModel::Arrays& __restrict out) {
  addProducts<true, false>(moments, residuals, J, gradient, out);
}

MBA_VO_MULTIVERSION
void addRolling(const double* __restrict moments, const double* __restrict residuals, const MomentJacobian& J,
                double* __restrict gradient, QuadraticModel::Arrays& __restrict out) {
  addProducts<true, true>(moments, residuals, J, gradient, out);
}

MBA_VO_MULTIVERSION
void addStill(const double* __restrict moments, const double* __restrict residuals, const MomentJacobian& J,
              double* __restrict gradient, QuadraticModel::Arrays& __restrict out) {
  addProducts<false, false>(moments, residuals, J, gradient, out);
}

}  // namespace

QuadraticModel::PatchGradient& QuadraticModel::placeForGradient() {
  return patch_gradients_.size() < patch_gradients_.capacity() ? patch_gradients_.emplace_back() : not_kept_;
}

void QuadraticModel::add(const PatchSums& sums, const PatchPath& path, double gain, bool moving, bool rolling) {
  const MomentJacobian J = jacobianOf(path, gain, moving, rolling);
  double* gradient = placeForGradient().data();
  (!moving   ? addStill
   : rolling ? addRolling
             : addMoving)(sums.moments.data(), sums.residuals.data(), J, gradient, arrays_);
}

void QuadraticModel::copyTo(NormalEquations<kStates>& equations) const {
  equations.cost = cost;
  for (int i = 0; i < kStates; ++i) {
    equations.gradient(i) = arrays_.gradient[i];
    for (int j = i; j < kStates; ++j) equations.hessian(i, j) = equations.hessian(j, i) = arrays_.hessian[i][j];
  }
}

}  // namespace mba_vo
