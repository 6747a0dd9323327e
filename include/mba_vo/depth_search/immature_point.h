#pragma once

#include <Eigen/Core>

#include "mba_vo/depth_search/measured_depth.h"

namespace mba_vo {

/// A point whose depth is still being found (DSO calls it immature).
struct ImmaturePoint {
  /// Outcome of the last search. Only kGood changes the interval.
  enum class State {
    kUninitialized,
    kGood,
    kOutlier,      // failed twice running, is not searched any more
    kOutOfBounds,  // the interval's image leaves the frame; may come back
    kSkipped,      // the interval is too short for an improvement
    kBadCondition  // no match for the first time, or the line runs along the edges, or no parallax
  };

  Eigen::Vector2i pixel;               // in its host keyframe, level 0
  double inverse_depth_min = 0.0;      // [1/m]
  double inverse_depth_max = -1.0;     // [1/m]; negative: no upper bound known yet
  double energy_threshold = 0.0;       // of the pattern, from its gradients; 0: not computed yet
  double quality = 0.0;                // second-best over best search energy; higher is more certain
  double last_search_length_px = 0.0;  // of the interval along the last frame's epipolar line, narrowed if kGood
  int failures = 0;                    // searches without match since the last good one
  State state = State::kUninitialized;

  MeasuredDepth measured;  // by a depth image: such a point need not be searched

  bool hasDepth() const { return inverse_depth_max > 0.0; }
  double inverseDepth() const { return 0.5 * (inverse_depth_min + inverse_depth_max); }
  /// How far it may be off [1/m].
  double uncertainty() const { return 0.5 * (inverse_depth_max - inverse_depth_min); }
};

/// Whether its depth is certain enough to enter the window.
bool isReadyToActivate(const ImmaturePoint& point);

}  // namespace mba_vo
