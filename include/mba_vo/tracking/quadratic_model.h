#pragma once

#include "mba_vo/blur/patch_path.h"
#include "mba_vo/solver/normal_equations.h"
#include "mba_vo/tracking/patch_sums.h"

namespace mba_vo {

/// Sums up the quadratic models of the patches, for the states (delta of T_mid, epsilon of xi, a, b). Plain padded
/// arrays: the compiler turns their loops into vector instructions of the machine that it runs on.
class QuadraticModel {
 public:
  static constexpr int kStates = 14;

  /// `gain`: e^a. `moving` false: xi is no state. `rolling`: the path has a J_xi_row.
  void add(const PatchSums& sums, const PatchPath& path, double gain, bool moving, bool rolling = false);
  void copyTo(NormalEquations<kStates>& equations) const;

  static constexpr int kColumns = 16;  // states padded to whole vectors
  struct Arrays {
    alignas(64) double hessian[kStates][kColumns] = {};
    alignas(64) double gradient[kColumns] = {};
  };
  double cost = 0.0;

 private:
  Arrays arrays_;
};

}  // namespace mba_vo
