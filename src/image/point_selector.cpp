#include "mba_vo/image/point_selector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "gradient_candidates.h"
#include "mba_vo/image/image_noise.h"

namespace mba_vo {
namespace {

constexpr int kMaxLevels = 3;             // of gradients: the finest and two coarser ones
constexpr float kSmallestCell = 3.0F;     // [px]
constexpr double kCountTolerance = 0.02;  // relative
constexpr int kMaxRounds = 10;
constexpr double kNoiseMargin = 3.5;  // of the gradient, per standard deviation of the noise: five of its own
constexpr double kFaintMargin = 3.0;  // the same for faint texture (docs/decisions/2026-11-28-faint-texture.md)
constexpr double kLeastNoise = 1.0;   // [grey levels] compression takes fine noise away, and leaves coarse errors

/// Direction along which the gradients of a cell are compared; spread over the half circle, different for neighbours.
Eigen::Vector2f directionOfCell(int column, int row) {
  static const std::array<Eigen::Vector2f, 16> kDirections = [] {
    std::array<Eigen::Vector2f, 16> directions;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const float angle = static_cast<float>(CV_PI / 16.0 * static_cast<double>(i));
      directions[i] = {std::cos(angle), std::sin(angle)};
    }
    return directions;
  }();
  return kDirections[static_cast<std::size_t>((7 * column + 3 * row) & 15)];
}

struct Choice {
  const GradientCandidate* candidate = nullptr;
  float score = -1.0F;
};

/// Cells of side `cell` << level over the image.
class CellGrid {
 public:
  CellGrid(cv::Size image, float cell, int level)
      : column_of_(cellsOf(image.width, cell, level)), row_of_(cellsOf(image.height, cell, level)) {}

  int columns() const { return column_of_.back() + 1; }
  int rows() const { return row_of_.back() + 1; }
  std::size_t size() const { return static_cast<std::size_t>(columns() * rows()); }
  int column(int x) const { return column_of_[static_cast<std::size_t>(x)]; }
  int row(int y) const { return row_of_[static_cast<std::size_t>(y)]; }
  std::size_t at(int column, int row) const { return static_cast<std::size_t>(row * columns() + column); }

 private:
  static std::vector<int> cellsOf(int length, float cell, int level) {
    std::vector<int> cells;
    const float inverse_cell = 1.0F / cell;
    for (int x = 0; x < length; ++x) cells.push_back(static_cast<int>(static_cast<float>(x) * inverse_cell) >> level);
    return cells;
  }

  std::vector<int> column_of_;  // of each column of the image
  std::vector<int> row_of_;
};

using Flags = std::vector<std::uint8_t>;  // of the cells of a grid

/// Groups of cells that a point of a finer level serves need none of their own.
Flags inherit(const CellGrid& finer, const Flags& served, const CellGrid& grid) {
  Flags inherited(grid.size(), 0);
  for (int row = 0; row < finer.rows(); ++row) {
    for (int column = 0; column < finer.columns(); ++column) {
      if (served[finer.at(column, row)] != 0) inherited[grid.at(column / 2, row / 2)] = 1;
    }
  }
  return inherited;
}

using CandidateLists = std::vector<std::vector<GradientCandidate>>;       // by level, finest first
using Selection = std::vector<std::pair<int, const GradientCandidate*>>;  // (level, candidate)

/// One point per cell; groups of cells that stay empty get one point from the next coarser level. Calls
/// body(level, grid, served) for each level, which adds to the cells that are served.
template <typename Body>
void forEachLevel(const CandidateLists& candidates, cv::Size image, float cell, const Body& body) {
  CellGrid grid(image, cell, 0);
  Flags served(grid.size(), 0);
  for (std::size_t level = 0; level < candidates.size(); ++level) {
    if (level > 0) {
      CellGrid coarser(image, cell, static_cast<int>(level));
      served = inherit(grid, served, coarser);
      grid = std::move(coarser);
    }
    body(level, grid, served);
  }
}

/// How many points there are with cells of that size.
std::size_t countWithCell(const CandidateLists& candidates, cv::Size image, float cell) {
  std::ptrdiff_t count = 0;
  forEachLevel(candidates, image, cell, [&](std::size_t level, const CellGrid& grid, Flags& served) {
    count -= std::count(served.begin(), served.end(), 1);
    for (const GradientCandidate& c : candidates[level]) served[grid.at(grid.column(c.x), grid.row(c.y))] = 1;
    count += std::count(served.begin(), served.end(), 1);
  });
  return static_cast<std::size_t>(count);
}

/// The best candidate of each cell.
Selection selectWithCell(const CandidateLists& candidates, cv::Size image, float cell) {
  Selection selection;
  forEachLevel(candidates, image, cell, [&](std::size_t level, const CellGrid& grid, Flags& served) {
    std::vector<Choice> best(grid.size());
    for (const GradientCandidate& candidate : candidates[level]) {
      const int column = grid.column(candidate.x);
      const int row = grid.row(candidate.y);
      if (served[grid.at(column, row)] != 0) continue;
      const Eigen::Vector2f direction = directionOfCell(column, row);
      const float score = std::abs(candidate.gx * direction.x() + candidate.gy * direction.y());
      Choice& choice = best[grid.at(column, row)];
      if (score > choice.score) choice = {&candidate, score};
    }
    for (std::size_t i = 0; i < best.size(); ++i) {
      if (best[i].candidate == nullptr) continue;
      selection.emplace_back(static_cast<int>(level), best[i].candidate);
      served[i] = 1;
    }
  });
  return selection;
}

/// Adapts the cell size until the number of points is close to `count`; takes the closest that was seen. The number of
/// points goes with the inverse square of the cell size where there is texture everywhere, slower elsewhere.
Selection selectCount(const CandidateLists& candidates, cv::Size image, int count) {
  const float largest_cell = static_cast<float>(std::max(image.width, image.height));
  float cell = std::sqrt(static_cast<float>(image.area()) / static_cast<float>(count));
  cell = std::clamp(cell, kSmallestCell, largest_cell);
  std::optional<float> best;
  double best_ratio = 0.0;
  for (int round = 0; round < kMaxRounds; ++round) {
    const double ratio = static_cast<double>(countWithCell(candidates, image, cell)) / count;
    if (std::abs(ratio - 1.0) < std::abs(best_ratio - 1.0)) {
      best = cell;
      best_ratio = ratio;
    }
    if (std::abs(ratio - 1.0) < kCountTolerance) break;
    const float next = std::clamp(cell * static_cast<float>(std::sqrt(ratio)), kSmallestCell, largest_cell);
    if (next == cell) break;
    cell = next;
  }
  return best ? selectWithCell(candidates, image, *best) : Selection();
}

/// Pixel of the finest level with the highest gradient among those that the candidate's pixel averages.
Eigen::Vector2i refineToFinest(const GradientCandidate& candidate, int level, const cv::Mat1f& magnitude,
                               const cv::Mat1b& allowed) {
  Eigen::Vector2i best(candidate.x, candidate.y);
  float best_magnitude = -1.0F;
  const int side = 1 << level;
  for (int y = candidate.y; y < std::min(candidate.y + side, magnitude.rows); ++y) {
    for (int x = candidate.x; x < std::min(candidate.x + side, magnitude.cols); ++x) {
      if (allowed(y, x) == 0 || !(magnitude(y, x) > best_magnitude)) continue;
      best = {x, y};
      best_magnitude = magnitude(y, x);
    }
  }
  return best;
}

void requireValid(const ImagePyramid& pyramid, int count, const PointSelectorConfig& config) {
  if (pyramid.levels() < 1) throw std::invalid_argument("point selection: the image pyramid is empty");
  if (count < 0) {
    throw std::invalid_argument("point selection: count is " + std::to_string(count) + ", must not be negative");
  }
  if (config.border < 0) {
    throw std::invalid_argument("point selection: border is " + std::to_string(config.border) +
                                ", must not be negative");
  }
}

}  // namespace

std::vector<Eigen::Vector2i> selectPoints(const ImagePyramid& pyramid, int count, const PointSelectorConfig& config) {
  requireValid(pyramid, count, config);
  if (count == 0) return {};
  const cv::Mat1f& image = pyramid.level(0).intensity;
  const cv::Mat1b allowed = makeAllowedMask(image, config.border);
  const cv::Mat1f magnitude = gradientMagnitude(image);
  const RegionMedians medians(magnitude, allowed);

  CandidateLists candidates;
  const double noise = static_cast<double>(estimateNoise(image));
  double margin = std::max(config.gradient_margin, kNoiseMargin * noise);
  candidates.push_back(findCandidates(image, magnitude, 0, allowed, medians, static_cast<float>(margin)));
  for (int level = 1; level < std::min(pyramid.levels(), kMaxLevels); ++level) {
    margin *= config.coarse_margin_factor;
    // A pixel is the mean of 4^level.
    if (config.faint_texture) margin = kFaintMargin * std::max(noise, kLeastNoise) / (1 << level);
    const cv::Mat1f& coarse = pyramid.level(level).intensity;
    candidates.push_back(
        findCandidates(coarse, gradientMagnitude(coarse), level, allowed, medians, static_cast<float>(margin)));
  }

  std::vector<Eigen::Vector2i> points;
  for (const auto& [level, candidate] : selectCount(candidates, image.size(), count)) {
    points.push_back(refineToFinest(*candidate, level, magnitude, allowed));
  }
  return points;
}

}  // namespace mba_vo
