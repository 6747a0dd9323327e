#include "mba_vo/simulation/texture_strokes.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace mba_vo {
namespace {

constexpr int kOversampling = 3;
constexpr int kShift = 4;  // fractional bits of drawn coordinates

/// One layer of smooth periodic noise.
cv::Mat1f noiseLayer(int side, cv::Size cells, cv::RNG& random) {
  constexpr int kBorder = 3;
  cv::Mat1f lattice(cells);
  random.fill(lattice, cv::RNG::UNIFORM, -1.0, 1.0);
  cv::Mat1f wrapped;
  cv::copyMakeBorder(lattice, wrapped, kBorder, kBorder, kBorder, kBorder, cv::BORDER_WRAP);
  const double sx = static_cast<double>(cells.width) / side;
  const double sy = static_cast<double>(cells.height) / side;
  const cv::Matx23d sample_at(sx, 0.0, kBorder, 0.0, sy, kBorder);
  cv::Mat1f layer;
  cv::warpAffine(wrapped, layer, sample_at, cv::Size(side, side), cv::INTER_CUBIC | cv::WARP_INVERSE_MAP);
  return layer;
}

}  // namespace

cv::Mat1f fractalNoise(int side, cv::Size cells, int octaves, double persistence, cv::RNG& random) {
  cv::Mat1f sum(side, side, 0.0F);
  double weight = 1.0;
  double total = 0.0;
  for (int i = 0; i < octaves && 4 * std::max(cells.width, cells.height) <= side; ++i) {
    cv::scaleAdd(noiseLayer(side, cells, random), weight, sum, sum);
    total += weight * weight;
    weight *= persistence;
    cells = cells * 2;
  }
  sum.convertTo(sum, CV_32F, 1.0 / std::sqrt(std::max(total, 1e-9)));
  return sum;
}

Canvas::Canvas(int side, double tone) : side_(side), fine_(side * kOversampling, side * kOversampling) {
  fine_.setTo(tone);
}

Canvas::Canvas(const cv::Mat1f& background) : side_(background.cols) {
  cv::resize(background, fine_, background.size() * kOversampling, 0, 0, cv::INTER_LINEAR);
}

cv::Point Canvas::scaled(cv::Point2d p) const {
  const double factor = static_cast<double>(side_ * kOversampling * (1 << kShift));
  return {cvRound(p.x * factor), cvRound(p.y * factor)};
}

void Canvas::line(cv::Point2d from, cv::Point2d to, double width, double tone) {
  const double length = std::max(cv::norm(to - from), 1e-9);
  const cv::Point2d along = (to - from) / length;
  const cv::Point2d across(-0.5 * width * along.y, 0.5 * width * along.x);
  polygon({from - across, to - across, to + across, from + across}, tone);
}

void Canvas::rectangle(cv::Point2d from, cv::Point2d to, double tone) {
  polygon({from, {to.x, from.y}, to, {from.x, to.y}}, tone);
}

void Canvas::polygon(const std::vector<cv::Point2d>& corners, double tone) {
  std::vector<cv::Point> points;
  points.reserve(corners.size());
  for (const cv::Point2d& corner : corners) points.push_back(scaled(corner));
  cv::fillPoly(fine_, std::vector<std::vector<cv::Point>>{points}, cv::Scalar(tone), cv::LINE_8, kShift);
}

void Canvas::regularPolygon(cv::Point2d center, double radius, int corners, double angle, double tone) {
  std::vector<cv::Point2d> points;
  for (int i = 0; i < corners; ++i) {
    const double a = angle + 2.0 * CV_PI * i / corners;
    points.emplace_back(center.x + radius * std::cos(a), center.y + radius * std::sin(a));
  }
  polygon(points, tone);
}

void Canvas::wrappedPolygon(cv::Point2d center, double radius, int corners, double tone, cv::RNG& random) {
  std::vector<cv::Point2d> points;
  for (int i = 0; i < corners; ++i) {
    const double a = 2.0 * CV_PI * (i + random.uniform(-0.3, 0.3)) / corners;
    const double r = radius * random.uniform(0.6, 1.0);
    points.emplace_back(r * std::cos(a), r * std::sin(a));
  }
  for (int shift = 0; shift < 9; ++shift) {
    const int column = shift % 3;
    const int row = shift / 3;
    const cv::Point2d copy = center + cv::Point2d(column - 1, row - 1);
    if (copy.x < -radius || copy.y < -radius || copy.x > 1.0 + radius || copy.y > 1.0 + radius) continue;
    std::vector<cv::Point2d> moved;
    moved.reserve(points.size());
    for (const cv::Point2d& p : points) moved.push_back(p + copy);
    polygon(moved, tone);
  }
}

void Canvas::ellipse(cv::Point2d center, cv::Point2d radii, double degrees, double tone) {
  const cv::Point axes = scaled(radii);
  cv::ellipse(fine_, scaled(center), cv::Size(axes.x, axes.y), degrees, 0.0, 360.0, cv::Scalar(tone), cv::FILLED,
              cv::LINE_8, kShift);
}

void Canvas::writeText(cv::Point2d from, cv::Point2d to, double line_height, double tone, cv::RNG& random) {
  const double letter = 0.55 * line_height;
  for (double y = from.y; y + line_height <= to.y + 1e-9; y += 1.5 * line_height) {
    for (double x = from.x; x + letter < to.x; x += letter) {
      if (random.uniform(0.0, 1.0) < 0.16) continue;  // a space
      const double left = x + 0.1 * letter;
      const double right = x + 0.75 * letter;
      const double top = y + (random.uniform(0, 3) == 0 ? 0.0 : 0.3 * line_height);
      const double width = 0.28 * letter;
      const int form = random.uniform(1, 16);  // each bit is one stroke of the letter
      if ((form & 1) != 0) line({left, top}, {left, y + line_height}, width, tone);
      if ((form & 2) != 0) line({right, top}, {right, y + line_height}, width, tone);
      if ((form & 4) != 0)
        line({left, y + line_height - 0.5 * width}, {right, y + line_height - 0.5 * width}, width, tone);
      if ((form & 8) != 0) line({left, top + 0.1 * line_height}, {right, y + 0.8 * line_height}, width, tone);
    }
  }
}

void Canvas::writeSpine(cv::Point2d start, double length, double height, double tone, cv::RNG& random) {
  const double letter = 0.7 * height;
  for (double y = start.y; y + letter < start.y + length; y += letter) {
    if (random.uniform(0, 6) == 0) continue;
    const double left = start.x - 0.5 * height;
    const double right = start.x + 0.5 * height;
    line({left, y}, {right, y}, 0.25 * letter, tone);
    if (random.uniform(0, 2) == 0)
      line({left, y}, {random.uniform(left, right), y + 0.6 * letter}, 0.25 * letter, tone);
    if (random.uniform(0, 2) == 0) line({right, y}, {right, y + 0.65 * letter}, 0.25 * letter, tone);
  }
}

void Canvas::paintHills(cv::Point2d from, cv::Point2d to, cv::RNG& random) {
  const cv::Point2d size = to - from;
  rectangle(from, to, random.uniform(0.65, 0.92));
  for (int cloud = 0; cloud < 14; ++cloud) {
    const cv::Point2d at = from + cv::Point2d(size.x * random.uniform(0.15, 0.85), size.y * random.uniform(0.1, 0.3));
    ellipse(at, {size.x * random.uniform(0.03, 0.11), size.y * random.uniform(0.01, 0.04)}, 0.0,
            random.uniform(0.55, 0.98));
  }
  for (int ridge = 0; ridge < 5; ++ridge) {
    const double base = 0.35 + 0.12 * ridge;
    const double tone = random.uniform(0.1, 0.6);
    std::vector<cv::Point2d> points = {{from.x, to.y}};
    for (int i = 0; i <= 16; ++i) {
      points.emplace_back(from.x + size.x * i / 16.0, from.y + size.y * (base + random.uniform(-0.07, 0.07)));
    }
    points.push_back(to);
    polygon(points, tone);
    for (int tree = 0; tree < 26; ++tree) {
      const cv::Point2d foot(from.x + size.x * random.uniform(0.03, 0.97),
                             from.y + size.y * std::min(base + random.uniform(0.07, 0.16), 0.99));
      const double h = size.y * random.uniform(0.02, 0.06);
      polygon({foot, foot + cv::Point2d(0.5 * h, 0.0), foot + cv::Point2d(0.25 * h, -h)}, random.uniform(0.05, 0.7));
    }
  }
}

void Canvas::paintHouses(cv::Point2d from, cv::Point2d to, cv::RNG& random) {
  const cv::Point2d size = to - from;
  for (int house = 0; house < 7; ++house) {
    const double w = size.x * random.uniform(0.08, 0.2);
    const double h = size.y * random.uniform(0.15, 0.5);
    const cv::Point2d corner(from.x + random.uniform(0.0, size.x - w), to.y - h);
    const double wall = random.uniform(0.3, 0.95);
    rectangle(corner, {corner.x + w, to.y}, wall);
    polygon({corner, corner + cv::Point2d(w, 0.0), corner + cv::Point2d(0.5 * w, -0.3 * w)}, 0.3 * wall);
    const int rows = random.uniform(2, 6);
    for (int i = 0; i < 3 * rows; ++i) {
      const int column = i % 3;
      const int row = i / 3;
      const cv::Point2d window = corner + cv::Point2d((0.12 + 0.3 * column) * w, (row + 0.25) * h / rows);
      rectangle(window, window + cv::Point2d(0.18 * w, 0.5 * h / rows), wall > 0.6 ? 0.12 : 0.9);
    }
  }
}

void Canvas::paintShapes(cv::Point2d from, cv::Point2d to, cv::RNG& random) {
  const cv::Point2d size = to - from;
  rectangle(from, to, random.uniform(0.2, 0.9));
  for (int i = 0; i < 60; ++i) {
    const double radius = size.x * random.uniform(0.015, 0.14);
    const cv::Point2d center(random.uniform(from.x + radius, to.x - radius),
                             random.uniform(from.y + radius, to.y - radius));
    const double tone = random.uniform(0.04, 0.96);
    if (i % 3 == 0) {
      ellipse(center, {radius, radius * random.uniform(0.4, 1.0)}, 0.0, tone);
    } else {
      regularPolygon(center, radius, random.uniform(3, 7), random.uniform(0.0, 3.0), tone);
    }
  }
}

void Canvas::paintPicture(cv::Point2d from, cv::Point2d to, cv::RNG& random) {
  if (random.uniform(0, 3) == 0) {
    paintShapes(from, to, random);
  } else {
    paintHills(from, to, random);
    paintHouses(from, to, random);
  }
}

cv::Mat1f Canvas::image() const {
  cv::Mat1f image;
  cv::resize(fine_, image, cv::Size(side_, side_), 0, 0, cv::INTER_AREA);
  return image;
}

}  // namespace mba_vo
