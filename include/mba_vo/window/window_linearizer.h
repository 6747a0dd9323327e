#pragma once

#include <optional>
#include <vector>

#include "mba_vo/solver/schur_complement.h"
#include "mba_vo/window/photometric_residual.h"
#include "mba_vo/window/window_state.h"

namespace mba_vo {

/// All residuals of some points of a window, evaluated.
struct WindowEvaluation {
  std::vector<int> points;               // their numbers
  std::vector<std::size_t> first;        // of a point's comparisons
  std::vector<PatchComparison> patches;  // one per residual, valid where it has a trial_energy
  std::vector<PairGeometry> pairs;       // in which they have residuals, of the state evaluated

  /// These, in order, some of `points`.
  void keepOnly(const std::vector<int>& some);
};

/// Evaluates residuals of a window and accumulates their normal equations. Points are cut in chunks whose bounds depend
/// only on their number and the chunks' sums are added in order, so the result does not depend on the threads used.
class WindowLinearizer {
 public:
  WindowLinearizer(const ResidualOptions& options, bool reblur_targets)
      : options_(options), reblur_targets_(reblur_targets) {}

  /// Evaluates all residuals of the points numbered `points` at the current state: writes their trial_energy and drift.
  /// `max_drift`: with new pixels before for those that have none, or whose projection is further from them [px].
  void evaluate(WindowState& state, const std::vector<int>& points, WindowEvaluation& out,
                std::optional<float> max_drift = std::nullopt) const;
  /// Gives every keyframe the Huber threshold that suits the residuals into it, and weighs them by it.
  void followResiduals(WindowState& state, WindowEvaluation& evaluation) const;
  /// New pixels, and evaluates the residuals concerned, all else as in `evaluation` of the current state.
  void replacePixels(WindowState& state, float max_drift, WindowEvaluation& evaluation) const;

  /// The normal equations of the good residuals (without any prior). Row i of the depth terms is point points[i].
  /// `evaluation`: at the current state.
  void assemble(const WindowState& state, const WindowEvaluation& evaluation, LinearizedWindow& out) const;
  /// Only the diagonal of the inverse depths.
  void assembleDepths(const WindowState& state, const WindowEvaluation& evaluation, Eigen::VectorXd& H_depth) const;

  /// Evaluates and assembles.
  void linearize(WindowState& state, const std::vector<int>& points, LinearizedWindow& out) const;

 private:
  struct PairSums;
  class Chunk;
  /// Calls body(pair, point, residual, comparison) for all residuals, those of different points on different threads.
  template <typename Body>
  static void forEachResidual(WindowState& state, WindowEvaluation& evaluation, const Body& body);
  bool place(const PairGeometry& pair, const PointState& point, float max_drift, PatchResidual& residual) const;
  void evaluateResidual(const PairGeometry& pair, const PointState& point, PatchResidual& residual,
                        PatchComparison& comparison) const;
  static void assemblePoint(const WindowState& state, const WindowEvaluation& evaluation, int row, Chunk& chunk,
                            LinearizedWindow& out);

  ResidualOptions options_;
  bool reblur_targets_;
};

}  // namespace mba_vo
