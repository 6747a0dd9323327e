#include "mba_vo/deblur/tiles.h"

#include <algorithm>

#include <opencv2/core/utility.hpp>

namespace mba_vo {
namespace {

/// Enough for what most networks see around a pixel, but not most of a small tile.
int overlapOf(int tile) {
  constexpr int kOverlap = 64;  // [px]
  constexpr int kPart = 4;
  return std::min(kOverlap, tile / kPart);
}

int paddedLength(int length, int tile, int grid) {
  return length <= tile ? tile : tile + cv::roundUp(length - tile, static_cast<unsigned>(grid));
}

/// `length`: by paddedLength.
std::vector<int> startsOf(int length, int tile, int grid, int overlap) {
  std::vector<int> starts{0};
  const int step = std::max(grid, (tile - overlap) / grid * grid);
  while (starts.back() + tile < length) starts.push_back(std::min(starts.back() + step, length - tile));
  return starts;
}

/// Along one side of a tile that begins at `start`; 1 up to the sides of the image.
std::vector<float> weightsAlong(int start, int tile, int length, int overlap) {
  std::vector<float> weights(static_cast<std::size_t>(tile), 1.0F);
  const float unused = 0.25F * static_cast<float>(overlap);
  const float fade = std::max(1.0F, 0.5F * static_cast<float>(overlap));
  for (int i = 0; i < tile; ++i) {
    const int before = start > 0 ? i : tile;
    const int behind = start + tile < length ? tile - 1 - i : tile;
    const float inside = static_cast<float>(std::min(before, behind)) + 0.5F;
    if (inside < static_cast<float>(overlap)) {
      constexpr float kLeast = 1e-6F;  // never nothing: where tiles do not overlap, it is all there is
      weights[static_cast<std::size_t>(i)] = std::clamp((inside - unused) / fade, kLeast, 1.0F);
    }
  }
  return weights;
}

}  // namespace

Tiles::Tiles(cv::Size image, cv::Size tile, int grid)
    : padded_(paddedLength(image.width, tile.width, grid), paddedLength(image.height, tile.height, grid)),
      overlap_x_(overlapOf(tile.width)),
      overlap_y_(overlapOf(tile.height)) {
  for (const int y : startsOf(padded_.height, tile.height, grid, overlap_y_)) {
    for (const int x : startsOf(padded_.width, tile.width, grid, overlap_x_)) all_.emplace_back(cv::Point(x, y), tile);
  }
}

cv::Mat1f Tiles::weights(const cv::Rect& tile) const {
  const std::vector<float> x = weightsAlong(tile.x, tile.width, padded_.width, overlap_x_);
  const std::vector<float> y = weightsAlong(tile.y, tile.height, padded_.height, overlap_y_);
  return cv::Mat1f(cv::Mat1f(y).reshape(1, tile.height) * cv::Mat1f(x).reshape(1, 1));
}

}  // namespace mba_vo
