#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace mba_vo {

/// Tiles of one size that cover an image and overlap, for networks that take one size only.
///
/// Near the inner sides of a tile a network sees less of the image than it wants: the outer quarter of the overlap is
/// not used, and in the half between, one tile fades into the next.
class Tiles {
 public:
  /// Tiles begin at multiples of `grid`, so that networks that halve the image halve it at the same pixels in each.
  Tiles(cv::Size image, cv::Size tile, int grid);

  /// What the image has to be filled up to.
  cv::Size padded() const { return padded_; }
  /// Within `padded`, row by row.
  const std::vector<cv::Rect>& all() const { return all_; }
  /// How much each pixel of a tile counts; over all tiles that see a pixel the sum is positive.
  cv::Mat1f weights(const cv::Rect& tile) const;

 private:
  cv::Size padded_;
  int overlap_x_, overlap_y_;  // the least there is [px]
  std::vector<cv::Rect> all_;
};

}  // namespace mba_vo
