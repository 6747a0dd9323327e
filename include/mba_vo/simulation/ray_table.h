#pragma once

#include <vector>

#include "mba_vo/image/frame_builder.h"

namespace mba_vo {

/// Axis-aligned rectangle of ray directions (x, y, 1).
struct RayRectangle {
  float x_min, x_max, y_min, y_max;
  void include(const RayRectangle& other);
};

/// 64 neighbouring pixels with their rays (x, y, 1) in the optical frame; 8x8, or 64x1 for a rolling shutter.
struct RayBlock {
  static constexpr int kPixels = 64;
  float x[kPixels];
  float y[kPixels];
  RayRectangle bounds;  // of all rays, half a pixel of margin included
  float x_col, x_row;   // change of x per pixel to the right and downwards
  float y_col, y_row;
  float pixel_size;  // side of a square as large as one pixel at z = 1
  int column, row;   // first pixel
};

/// A row of blocks: the unit of work of the renderer.
struct RayStrip {
  RayRectangle bounds;
  int row = 0;  // first row [px]
  std::vector<RayBlock> blocks;
};

/// The ray of every pixel of a distorted camera.
class RayTable {
 public:
  /// `rows_per_strip`: 8, or 1 when every row has its own pose.
  /// Throws std::invalid_argument where the distortion cannot be undone within the image.
  RayTable(const CameraCalibration& calibration, int rows_per_strip);

  const std::vector<RayStrip>& strips() const { return strips_; }
  int width() const { return width_; }
  int height() const { return height_; }
  int rowsPerBlock() const { return rows_; }
  int columnsPerBlock() const { return RayBlock::kPixels / rows_; }
  const RayRectangle& bounds() const { return bounds_; }

 private:
  int width_;
  int height_;
  int rows_;
  RayRectangle bounds_;
  std::vector<RayStrip> strips_;
};

}  // namespace mba_vo
