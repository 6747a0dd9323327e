#include "mba_vo/depth_search/surface_slope.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace mba_vo {
namespace {

constexpr double kNeighbourRadius = 40.0;  // [px]
constexpr std::size_t kMaxNeighbours = 14;
constexpr std::size_t kUsualCandidates = 128;  // to choose them from
constexpr std::size_t kMinNeighbours = 4;
constexpr double kMinAgreeing = 0.5;  // share of the neighbours that must lie on the surface
constexpr int kIterations = 5;
// Relative to the inverse depth:
constexpr double kOtherSurface = 0.07;  // a neighbour further off the surface is on another one
constexpr double kNoise = 0.01;         // of one neighbour
constexpr double kSlopeSigma = 0.003;   // prior, around fronto-parallel [1/px]
constexpr double kMinOwnSigma = 0.002;
constexpr double kMaxOwnSigma = 0.05;

int cellOf(double coordinate, int cells) {
  return std::clamp(static_cast<int>(coordinate / kNeighbourRadius), 0, cells - 1);
}

/// A heavy tail at first, so that no neighbour is lost to a bad start; then none beyond an edge.
double weight(double residual, bool first) {
  const double t = residual / kOtherSurface;
  if (first) return 1.0 / (1.0 + t * t);
  const double tukey = std::max(0.0, 1.0 - t * t);
  return tukey * tukey;
}

}  // namespace

SurfaceSlopes::SurfaceSlopes(const PinholeCamera& camera, const std::vector<ReferencePoint>& points)
    : columns_(static_cast<int>(std::ceil(camera.width / kNeighbourRadius))),
      rows_(static_cast<int>(std::ceil(camera.height / kNeighbourRadius))),
      cells_(static_cast<std::size_t>(columns_ * rows_)) {
  for (const ReferencePoint& point : points) {
    const Eigen::Vector2d pixel = point.pixel.cast<double>();
    const int cell = cellOf(pixel.y(), rows_) * columns_ + cellOf(pixel.x(), columns_);
    cells_[static_cast<std::size_t>(cell)].push_back({pixel, static_cast<double>(point.inverse_depth)});
  }
}

std::vector<SurfaceSlopes::Neighbour> SurfaceSlopes::neighbours(const Eigen::Vector2d& pixel,
                                                                double inverse_depth) const {
  std::vector<Neighbour> found;
  found.reserve(kUsualCandidates);
  const int column = cellOf(pixel.x(), columns_);
  const int row = cellOf(pixel.y(), rows_);
  for (int r = std::max(row - 1, 0); r <= std::min(row + 1, rows_ - 1); ++r) {
    for (int c = std::max(column - 1, 0); c <= std::min(column + 1, columns_ - 1); ++c) {
      for (const Point& point : cells_[static_cast<std::size_t>(r * columns_ + c)]) {
        const Eigen::Vector2d offset = point.pixel - pixel;
        const double squared_distance = offset.squaredNorm();
        // Nearer than a pixel it is the point itself.
        if (squared_distance < 1.0 || squared_distance > kNeighbourRadius * kNeighbourRadius) continue;
        found.push_back({squared_distance, offset, point.inverse_depth / inverse_depth - 1.0});
      }
    }
  }
  if (found.size() > kMaxNeighbours) {
    std::nth_element(found.begin(), found.begin() + kMaxNeighbours, found.end(),
                     [](const Neighbour& a, const Neighbour& b) { return a.squared_distance < b.squared_distance; });
    found.resize(kMaxNeighbours);
  }
  return found;
}

Eigen::Vector2d SurfaceSlopes::at(const Eigen::Vector2d& pixel, double inverse_depth, double variance) const {
  const std::vector<Neighbour> near = neighbours(pixel, inverse_depth);
  if (near.size() < kMinNeighbours) return Eigen::Vector2d::Zero();
  const double own_sigma = std::min(kMaxOwnSigma, std::sqrt(variance) / inverse_depth) + kMinOwnSigma;
  const Eigen::Vector3d sigma(kSlopeSigma, kSlopeSigma, own_sigma);
  const Eigen::Matrix3d prior = sigma.array().square().inverse().matrix().asDiagonal();
  Eigen::Vector3d surface = Eigen::Vector3d::Zero();  // slope and error of the point's own inverse depth
  const auto residualOf = [&surface](const Neighbour& n) {
    return n.relative_difference - n.offset.dot(surface.head<2>()) - surface.z();
  };
  for (int i = 0; i < kIterations; ++i) {
    Eigen::Matrix3d H = prior;
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const Neighbour& n : near) {
      const Eigen::Vector3d J(n.offset.x(), n.offset.y(), 1.0);
      const double w = weight(residualOf(n), i == 0) / (kNoise * kNoise);
      H += w * J * J.transpose();
      b += w * n.relative_difference * J;
    }
    surface = H.inverse() * b;  // positive definite and 3x3: the fastest way
  }
  const auto agreeing = std::count_if(near.begin(), near.end(),
                                      [&](const Neighbour& n) { return std::abs(residualOf(n)) < kOtherSurface; });
  if (static_cast<double>(agreeing) < kMinAgreeing * static_cast<double>(near.size())) return Eigen::Vector2d::Zero();
  return inverse_depth * surface.head<2>();
}

}  // namespace mba_vo
