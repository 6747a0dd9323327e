#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace mba_vo {

/// Periodic noise: `octaves` layers, the coarsest with `cells` bumps across and down, each next one twice as fine and
/// `persistence` times as strong; about -1 to 1. Layers finer than four texels are left out.
cv::Mat1f fractalNoise(int side, cv::Size cells, int octaves, double persistence, cv::RNG& random);

/// Draws anti-aliased shapes on a square image of reflectances. Positions and lengths in units of the side.
class Canvas {
 public:
  Canvas(int side, double tone);
  explicit Canvas(const cv::Mat1f& background);

  void line(cv::Point2d from, cv::Point2d to, double width, double tone);
  void rectangle(cv::Point2d from, cv::Point2d to, double tone);
  void polygon(const std::vector<cv::Point2d>& corners, double tone);
  void regularPolygon(cv::Point2d center, double radius, int corners, double angle, double tone);
  /// An irregular polygon that continues at the opposite border.
  void wrappedPolygon(cv::Point2d center, double radius, int corners, double tone, cv::RNG& random);
  void ellipse(cv::Point2d center, cv::Point2d radii, double degrees, double tone);
  /// Fills a rectangle with lines of strokes that look like words.
  void writeText(cv::Point2d from, cv::Point2d to, double line_height, double tone, cv::RNG& random);
  /// The same in one line downwards.
  void writeSpine(cv::Point2d start, double length, double height, double tone, cv::RNG& random);
  /// A landscape with sky, hills, houses and trees, or an arrangement of shapes.
  void paintPicture(cv::Point2d from, cv::Point2d to, cv::RNG& random);

  cv::Mat1f image() const;

 private:
  cv::Point scaled(cv::Point2d p) const;
  void paintHills(cv::Point2d from, cv::Point2d to, cv::RNG& random);
  void paintHouses(cv::Point2d from, cv::Point2d to, cv::RNG& random);
  void paintShapes(cv::Point2d from, cv::Point2d to, cv::RNG& random);

  int side_;
  cv::Mat1f fine_;  // drawn at kOversampling times the resolution
};

}  // namespace mba_vo
