#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "mba_vo/blur/patch_path.h"
#include "mba_vo/solver/normal_equations.h"
#include "mba_vo/tracking/patch_sums.h"

namespace mba_vo {

/// Sums up the quadratic models of the patches, for the states (delta of T_mid, epsilon of xi, a, b, turning part of
/// the bend, log exposure at a given velocity). Plain padded arrays: the compiler turns their loops into vector
/// instructions of the machine that it runs on.
class QuadraticModel {
 public:
  static constexpr int kStates = 18;
  static constexpr int kColumns = 24;  // states padded to whole vectors
  using PatchGradient = std::array<double, kColumns>;

  /// Keeps the gradients of so many patches one by one.
  explicit QuadraticModel(std::size_t kept_gradients = 0) { patch_gradients_.reserve(kept_gradients); }

  /// `gain`: e^a. `moving` false: xi is no state. `rolling`: the path has a J_xi_row, and the
  /// bend and the exposure are states.
  void add(const PatchSums& sums, const PatchPath& path, double gain, bool moving, bool rolling = false);
  void copyTo(NormalEquations<kStates>& equations) const;
  /// What each of the first patches added to the gradient, padded with zeros.
  std::vector<PatchGradient> takePatchGradients() { return std::move(patch_gradients_); }

  struct Arrays {
    alignas(64) double hessian[kStates][kColumns] = {};
    alignas(64) double gradient[kColumns] = {};
  };
  double cost = 0.0;

 private:
  PatchGradient& placeForGradient();

  Arrays arrays_;
  PatchGradient not_kept_{};
  std::vector<PatchGradient> patch_gradients_;
};

}  // namespace mba_vo
