#pragma once

#include <vector>

#include "mba_vo/mapping/photometric_residual.h"
#include "mba_vo/mapping/schur_complement.h"
#include "mba_vo/mapping/window_state.h"

namespace mba_vo {

/// Evaluates residuals of a window and accumulates their normal equations. Points are cut in chunks whose bounds depend
/// only on their number and the chunks' sums are added in order, so the result does not depend on the threads used.
class WindowLinearizer {
 public:
  WindowLinearizer(const ResidualOptions& options, bool reblur_targets)
      : options_(options), reblur_targets_(reblur_targets) {}

  /// (Re)places the pixels of residuals that have none or whose projection is more than `max_drift` px from its set.
  void placePixels(WindowState& state, float max_drift) const;

  /// Evaluates all residuals of the points numbered `points` at the current state: writes trial_energy and drift of
  /// each residual and the normal equations of the good ones (without any prior). Row i of the depth terms is point
  /// points[i].
  void linearize(WindowState& state, const std::vector<int>& points, LinearizedWindow& out) const;

 private:
  struct Chunk;
  void linearizePoint(WindowState& state, const std::vector<PairGeometry>& pairs, PointState& point, int row,
                      Chunk& chunk, LinearizedWindow& out) const;

  ResidualOptions options_;
  bool reblur_targets_;
};

}  // namespace mba_vo
