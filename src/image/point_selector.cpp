#include "mba_vo/image/point_selector.h"

#include <algorithm>
#include <array>
#include <cmath>
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

/// Cells of side `cell` << level over the image: the best candidate of each, and whether a finer level served it
/// already.
class CellGrid {
 public:
  CellGrid(cv::Size image, float cell, int level)
      : shift_(level),
        inverse_cell_(1.0F / cell),
        columns_(index(image.width - 1) + 1),
        rows_(index(image.height - 1) + 1),
        best_(static_cast<std::size_t>(columns_ * rows_)),
        served_(best_.size(), false) {}

  /// Cells with a point in the grid of the next finer level need none of their own.
  void inherit(const CellGrid& finer) {
    for (int row = 0; row < finer.rows_; ++row) {
      for (int column = 0; column < finer.columns_; ++column) {
        const std::size_t i = finer.at(column, row);
        if (finer.served_[i] || finer.best_[i].candidate != nullptr) served_[at(column / 2, row / 2)] = true;
      }
    }
  }

  void offer(const GradientCandidate& candidate) {
    const int column = index(candidate.x);
    const int row = index(candidate.y);
    if (served_[at(column, row)]) return;
    const Eigen::Vector2f direction = directionOfCell(column, row);
    const float score = std::abs(candidate.gx * direction.x() + candidate.gy * direction.y());
    Choice& choice = best_[at(column, row)];
    if (score > choice.score) choice = {&candidate, score};
  }

  const std::vector<Choice>& choices() const { return best_; }

 private:
  int index(int x) const { return static_cast<int>(static_cast<float>(x) * inverse_cell_) >> shift_; }
  std::size_t at(int column, int row) const { return static_cast<std::size_t>(row * columns_ + column); }

  int shift_;
  float inverse_cell_;
  int columns_, rows_;
  std::vector<Choice> best_;
  std::vector<bool> served_;
};

using CandidateLists = std::vector<std::vector<GradientCandidate>>;       // by level, finest first
using Selection = std::vector<std::pair<int, const GradientCandidate*>>;  // (level, candidate)

/// One point per cell; groups of cells that stay empty get one point from the next coarser level.
Selection selectWithCell(const CandidateLists& candidates, cv::Size image, float cell) {
  Selection selection;
  std::optional<CellGrid> finer;
  for (std::size_t level = 0; level < candidates.size(); ++level) {
    CellGrid grid(image, cell, static_cast<int>(level));
    if (finer) grid.inherit(*finer);
    for (const GradientCandidate& candidate : candidates[level]) grid.offer(candidate);
    for (const Choice& choice : grid.choices()) {
      if (choice.candidate != nullptr) selection.emplace_back(static_cast<int>(level), choice.candidate);
    }
    finer = std::move(grid);
  }
  return selection;
}

/// Adapts the cell size until the number of points is close to `count`; keeps the closest that was seen. The number of
/// points goes with the inverse square of the cell size where there is texture everywhere, slower elsewhere.
Selection selectCount(const CandidateLists& candidates, cv::Size image, int count) {
  const float largest_cell = static_cast<float>(std::max(image.width, image.height));
  float cell = std::sqrt(static_cast<float>(image.area()) / static_cast<float>(count));
  cell = std::clamp(cell, kSmallestCell, largest_cell);
  Selection best;
  for (int round = 0; round < kMaxRounds; ++round) {
    Selection selection = selectWithCell(candidates, image, cell);
    const double ratio = static_cast<double>(selection.size()) / count;
    const bool closer = std::abs(ratio - 1.0) < std::abs(static_cast<double>(best.size()) / count - 1.0);
    if (closer) best = std::move(selection);
    if (std::abs(ratio - 1.0) < kCountTolerance) break;
    const float next = std::clamp(cell * static_cast<float>(std::sqrt(ratio)), kSmallestCell, largest_cell);
    if (next == cell) break;
    cell = next;
  }
  return best;
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
  const GradientImage finest = computeGradients(image);
  const RegionMedians medians(finest.magnitude, allowed);

  CandidateLists candidates;
  const double noise = static_cast<double>(estimateNoise(image));
  double margin = std::max(config.gradient_margin, kNoiseMargin * noise);
  candidates.push_back(findCandidates(finest, 0, allowed, medians, static_cast<float>(margin)));
  for (int level = 1; level < std::min(pyramid.levels(), kMaxLevels); ++level) {
    margin *= config.coarse_margin_factor;
    const GradientImage gradients = computeGradients(pyramid.level(level).intensity);
    candidates.push_back(findCandidates(gradients, level, allowed, medians, static_cast<float>(margin)));
  }

  std::vector<Eigen::Vector2i> points;
  for (const auto& [level, candidate] : selectCount(candidates, image.size(), count)) {
    points.push_back(refineToFinest(*candidate, level, finest.magnitude, allowed));
  }
  return points;
}

}  // namespace mba_vo
