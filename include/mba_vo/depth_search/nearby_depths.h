#pragma once

#include <vector>

#include <Eigen/Core>

#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// Of a point that nothing has been measured of.
struct DepthGuess {
  double inverse_depth;  // [1/m]
  double sigma;          // of it [1/m]
};

/// Guesses of inverse depths where nothing is known, from the points around: means with the inverse fourth power of
/// the distance as weight. Far from all points they are as good as any.
class NearbyDepths {
 public:
  explicit NearbyDepths(const std::vector<ReferencePoint>& points);

  /// False if there are too few points to guess by.
  bool known() const { return known_; }
  /// As uncertain as the points around differ, and never less than by a step of a surface.
  DepthGuess at(const Eigen::Vector2d& pixel) const;

 private:
  bool known_;
  std::vector<ReferencePoint> sample_;
};

}  // namespace mba_vo
