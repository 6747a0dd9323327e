#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/deblur/latent_path.h"

namespace mba_vo {

/// The grid of unknowns: the sharp image with a margin all around, because the blurred image's border has seen what is
/// beyond it.
struct LatentGrid {
  int margin = 0;  // [px]
  cv::Size size;   // with margins, the image's own sides rounded up to whole tiles
};

/// The linear map A from a sharp image to the blurred one laid over it: (A L)(x) is the mean of L along the path (Eq.
/// 6) that takes the blurred image's pixel through x of the sharp one at mid-exposure. For a keyframe and its sharp
/// image the two pixels are the same; a neighbouring frame's image is laid over the keyframe by `overlay`. The paths
/// are those of `blur/`, made once per tile of 8x8 pixels: each tile becomes a list of weighted taps that all its
/// pixels share. So both A and its transpose are nothing but sums of shifted rows, some ten times as fast as
/// interpolating for every pixel, and exact transposes of each other.
class BlurOperator {
 public:
  static constexpr int kTile = 8;  // [px]

  /// `inverse_depth`: of every pixel of the sharp image, without margin [1/m], all positive.
  BlurOperator(const BlurGeometry& geometry, const cv::Mat1f& inverse_depth, const LatentGrid& grid);

  /// Grid for a sharp image such that paths may go `reach_px` beyond its border.
  static LatentGrid gridFor(const PinholeCamera& latent_camera, int reach_px);

  const LatentGrid& grid() const { return grid_; }
  /// Size of the blurred image laid over the sharp one, whose size it has, rounded up to whole tiles.
  cv::Size observedSize() const { return observed_; }
  /// 1 at the pixels of the blurred image that have a path on the grid, 0 at the others.
  const cv::Mat1f& seen() const { return seen_; }

  /// Variance that blurring leaves of white noise of variance 1: the mean over the tiles of the squared taps' sum.
  float noiseGain() const;

  /// blurred = A latent; 0 at pixels that are not seen.
  void apply(const cv::Mat1f& latent, cv::Mat1f& blurred) const;
  /// latent += A^T blurred.
  void addTransposed(const cv::Mat1f& blurred, cv::Mat1f& latent) const;

 private:
  struct Tap {
    std::int32_t offset;  // from a pixel of the tile to one on the grid
    float weight;
  };
  struct Tile {
    std::int32_t pixel;   // index of its first pixel in the blurred image
    std::int32_t origin;  // index of the same pixel on the grid
    std::int32_t first_tap;
    std::int32_t taps;
  };
  class Builder;

  void applyTiles(const float* latent, float* blurred) const;
  void addTilesTransposed(const float* blurred, float* latent) const;

  LatentGrid grid_;
  cv::Size observed_;
  std::vector<Tile> tiles_;
  std::vector<Tap> taps_;
  cv::Mat1f seen_;
};

}  // namespace mba_vo
