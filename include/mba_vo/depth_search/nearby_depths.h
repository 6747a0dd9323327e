#pragma once

#include <vector>

#include <Eigen/Core>

#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// Guesses of inverse depths where nothing is known, from the points around: means with the inverse fourth power of
/// the distance as weight. Far from all points they are as good as any.
class NearbyDepths {
 public:
  explicit NearbyDepths(const std::vector<ReferencePoint>& points);

  /// False if there are too few points to guess by.
  bool known() const { return known_; }
  struct Guess {
    double inverse_depth;  // [1/m]
    double sigma;          // of it, by how much the points around differ; never less than a step of a surface [1/m]
  };
  Guess at(const Eigen::Vector2d& pixel) const;

 private:
  bool known_;
  std::vector<ReferencePoint> sample_;
};

}  // namespace mba_vo
