#pragma once

#include <vector>

#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

/// What stays the same during one call of track().
struct Tracker::Job {
  Job(const Reference& r, const Frame& f, const TrackingGuess& g, int levels, int max_points);

  const Reference& reference;
  const Frame& frame;
  const TrackingGuess& guess;
  bool rolling;                          // shutter
  double exposure;                       // that xi belongs to [s]
  double median_depth;                   // [m]
  std::vector<std::vector<int>> points;  // to be aligned, by level

  /// Coarse levels see less detail per patch, and 9x9 pixels there span too much depth.
  static int patchSide(int level) { return level <= 1 ? 9 : 7; }
  double fx() const { return reference.pyramid->level(0).camera.fx; }
  /// Of the logarithm of an exposure that nobody told, standard deviation; 0 of one that came.
  double untold() const;
  double exposureOf(const AlignmentState& state) const;  // [s]
  /// With a direction to descend along where none is known: at xi = 0 the derivative of the blur vanishes.
  Vector6 seeded(const Vector6& xi) const;
  /// Rotation between two states, as the image sees it [px of the finest level].
  double turn(const AlignmentState& l, const AlignmentState& r) const;
};

}  // namespace mba_vo
