#include "mba_vo/simulation/ray_table.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <opencv2/calib3d.hpp>

#include "mba_vo/image/corrected_calibration.h"

namespace mba_vo {
namespace {

constexpr double kMargin = 0.51;            // [px], half a pixel and rounding
constexpr double kLargestRoundTrip = 0.02;  // [px]

class RaySolver {
 public:
  explicit RaySolver(const CameraCalibration& c)
      : calibration_(c),
        K_(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1),
        D_(c.distortion),
        fisheye_(c.distortion_model == "equidistant") {}

  std::vector<cv::Point2d> undistort(const std::vector<cv::Point2d>& pixels) const {
    std::vector<cv::Point2d> rays;
    if (calibration_.distortion_model == "fov") {
      for (const cv::Point2d& pixel : pixels) rays.push_back(rayOfFovPixel(calibration_, pixel));
    } else if (fisheye_) {
      cv::fisheye::undistortPoints(pixels, rays, K_, D_);
    } else {
      const cv::TermCriteria precise(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-10);
      cv::undistortPoints(pixels, rays, K_, D_, cv::noArray(), cv::noArray(), precise);
    }
    checkRoundTrip(pixels, rays);
    return rays;
  }

 private:
  void checkRoundTrip(const std::vector<cv::Point2d>& pixels, const std::vector<cv::Point2d>& rays) const {
    std::vector<cv::Point3d> points;
    points.reserve(rays.size());
    for (const auto& ray : rays) points.emplace_back(ray.x, ray.y, 1.0);
    const std::vector<cv::Point2d> back = projectRays(calibration_, points);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (cv::norm(back[i] - pixels[i]) < kLargestRoundTrip) continue;
      throw std::invalid_argument("distortion: cannot be undone at pixel (" + std::to_string(pixels[i].x) + ", " +
                                  std::to_string(pixels[i].y) +
                                  "); every pixel must see one ray less than 90 degrees off the axis");
    }
  }

  CameraCalibration calibration_;
  cv::Matx33d K_;
  std::vector<double> D_;
  bool fisheye_;
};

RayBlock makeBlock(const std::vector<cv::Point2d>& grid, int grid_width, int column, int row, int columns, int rows,
                   const cv::Size& image) {
  RayBlock block{};
  block.column = column;
  block.row = row;
  // The grid holds one more pixel on every side, so a block's neighbours exist.
  const auto ray = [&](int c, int r) { return grid[static_cast<std::size_t>((r + 1) * grid_width + c + 1)]; };
  block.bounds = {1e9F, -1e9F, 1e9F, -1e9F};
  for (int i = 0; i < RayBlock::kPixels; ++i) {
    const int c = std::min(column + i % columns, image.width - 1);
    const int r = std::min(row + i / columns, image.height - 1);
    const cv::Point2d center = ray(c, r);
    block.x[i] = static_cast<float>(center.x);
    block.y[i] = static_cast<float>(center.y);
    const cv::Point2d dx = kMargin * 0.5 * (ray(c + 1, r) - ray(c - 1, r));
    const cv::Point2d dy = kMargin * 0.5 * (ray(c, r + 1) - ray(c, r - 1));
    const double margin_x = std::abs(dx.x) + std::abs(dy.x);
    const double margin_y = std::abs(dx.y) + std::abs(dy.y);
    block.bounds.include({static_cast<float>(center.x - margin_x), static_cast<float>(center.x + margin_x),
                          static_cast<float>(center.y - margin_y), static_cast<float>(center.y + margin_y)});
  }
  const int c = std::min(column + columns / 2, image.width - 1);
  const int r = std::min(row + rows / 2, image.height - 1);
  const cv::Point2d dx = 0.5 * (ray(c + 1, r) - ray(c - 1, r));
  const cv::Point2d dy = 0.5 * (ray(c, r + 1) - ray(c, r - 1));
  block.x_col = static_cast<float>(dx.x);
  block.y_col = static_cast<float>(dx.y);
  block.x_row = static_cast<float>(dy.x);
  block.y_row = static_cast<float>(dy.y);
  block.pixel_size = static_cast<float>(std::sqrt(std::abs(dx.cross(dy))));
  return block;
}

}  // namespace

void RayRectangle::include(const RayRectangle& other) {
  x_min = std::min(x_min, other.x_min);
  x_max = std::max(x_max, other.x_max);
  y_min = std::min(y_min, other.y_min);
  y_max = std::max(y_max, other.y_max);
}

RayTable::RayTable(const CameraCalibration& calibration, int rows_per_strip)
    : width_(calibration.width), height_(calibration.height), rows_(rows_per_strip) {
  const int grid_width = width_ + 2;
  std::vector<cv::Point2d> pixels;
  for (int r = -1; r <= height_; ++r) {
    for (int c = -1; c <= width_; ++c) pixels.emplace_back(c, r);
  }
  const std::vector<cv::Point2d> grid = RaySolver(calibration).undistort(pixels);
  const cv::Size image(width_, height_);
  for (int row = 0; row < height_; row += rows_) {
    RayStrip strip;
    strip.row = row;
    for (int column = 0; column < width_; column += columnsPerBlock()) {
      strip.blocks.push_back(makeBlock(grid, grid_width, column, row, columnsPerBlock(), rows_, image));
    }
    strip.bounds = strip.blocks.front().bounds;
    for (const RayBlock& block : strip.blocks) strip.bounds.include(block.bounds);
    strips_.push_back(std::move(strip));
  }
  bounds_ = strips_.front().bounds;
  for (const RayStrip& strip : strips_) bounds_.include(strip.bounds);
}

}  // namespace mba_vo
