#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace mba_vo {

/// What a block of an image tells about its shift.
struct BlockShift {
  Eigen::Vector2f shift = Eigen::Vector2f::Zero();           // [px]
  Eigen::Matrix2f covariance = Eigen::Matrix2f::Identity();  // [px^2], by its gradients and residuals
  bool told = false;                                         // anything at all
};

/// By how much an observed image is shifted against the predicted one, block by block: observed(x) = predicted(x + s).
struct Alignment {
  static constexpr int kBlock = 16;  // [px]

  int columns = 0, rows = 0;
  std::vector<BlockShift> blocks;  // row by row

  /// Lengths of the shifts that are known to a quarter of a pixel [px].
  std::vector<float> knownShifts() const;
};

/// One step of Lucas and Kanade per block, over the pixels with a positive weight.
Alignment measureAlignment(const cv::Mat1f& predicted, const cv::Mat1f& observed, const cv::Mat1f& weight);

/// The smooth field of shifts that the blocks tell of, one per block [px]: where a block tells little, or only across
/// its edges, those around it decide.
cv::Mat2f smoothShifts(const Alignment& alignment);

}  // namespace mba_vo
