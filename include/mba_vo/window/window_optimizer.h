#pragma once

#include <optional>

#include "mba_vo/solver/reduced_camera_solver.h"
#include "mba_vo/solver/settled_points.h"
#include "mba_vo/window/near_depth_penalty.h"
#include "mba_vo/window/scale_prior.h"
#include "mba_vo/window/window_linearizer.h"

namespace mba_vo {

struct WindowOptimizerOptions {
  double initial_lambda = 1e-4;
  double min_lambda = 1e-7;
  double max_lambda = 1e6;
  double min_relative_decrease = 1e-5;  // of the cost; a smaller one ends the optimisation
  double min_step = 1e-9;               // [m, rad] of all poses; a smaller one ends the optimisation
  float max_drift_px = 0.75F;           // beyond it a residual gets new pixels
};

/// Levenberg-Marquardt on all states of a window, in pieces: `begin`, `iterate` while it says that there is more to do,
/// and `finish`, which may come at any time between. The state must not change in other ways meanwhile.
class WindowOptimizer {
 public:
  WindowOptimizer(const WindowLinearizer& linearizer, double huber_threshold, const WindowOptimizerOptions& options)
      : linearizer_(linearizer), huber_threshold_(huber_threshold), options_(options) {}

  void begin(WindowState& state, const ScalePrior& scale_prior, int max_iterations);
  /// One step, taken or refused. False: no more are wanted.
  bool iterate(WindowState& state, const ScalePrior& scale_prior);
  /// By `begin`, or the last `iterate`.
  int evaluatedResiduals() const { return static_cast<int>(evaluation_.patches.size()); }
  WindowSummary finish(WindowState& state, const ScalePrior& scale_prior);

  /// Sum of the energies at the current state; an outlier counts with its keyframe's threshold.
  static double photometricCost(const WindowState& state);

 private:
  struct Step;
  struct Backup;
  void evaluate(WindowState& state);
  void acceptEnergies(WindowState& state) const;
  void updateOutlierThresholds(WindowState& state) const;
  double otherCost(const WindowState& state, const ScalePrior& scale_prior) const;
  bool solve(const WindowState& state, const ScalePrior& scale_prior, Step& step);
  void settle(WindowState& state, Step& step);
  void move(WindowState& state, const Step& step);
  void placeSettled(WindowState& state) const;
  double costChange(const WindowState& state) const;
  void accept(WindowState& state);
  void summarize(WindowState& state);

  WindowLinearizer linearizer_;
  double huber_threshold_;
  WindowOptimizerOptions options_;
  ReducedCameraSolver solver_;
  SchurComplement schur_;
  std::vector<int> moving_;      // points that have not settled
  WindowEvaluation evaluation_;  // of these, at the last state tried
  LinearizedWindow system_;      // of these, at the current state
  SettledPoints settled_;
  ReducedSystem reduced_;
  double step_norm_ = 0.0;
  std::optional<NearDepthPenalty> penalty_;  // while it is optimising
  int max_iterations_ = 0;
  double lambda_ = 0.0;
  WindowSummary summary_;
};

}  // namespace mba_vo
