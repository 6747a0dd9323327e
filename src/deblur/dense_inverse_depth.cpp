#include "mba_vo/deblur/dense_inverse_depth.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <opencv2/imgproc.hpp>

namespace mba_vo {
namespace {

constexpr int kCell = 8;          // [px]
constexpr float kBucket = 32.0F;  // [px]
constexpr std::size_t kNeighbours = 12;
constexpr int kIterations = 4;
constexpr float kNear = 12.0F;  // distance at which a sample's weight has fallen to a half [px]
// Relative to the inverse depth:
constexpr float kEdge = 0.1F;               // samples further off the plane are on another surface
constexpr float kSlopeSigma = 0.003F;       // prior, around fronto-parallel [1/px]
constexpr float kNoise = 0.02F;             // of a sample
constexpr float kMostExtrapolation = 0.1F;  // beyond the samples that were used

struct Neighbour {
  float squared_distance;  // [px^2]
  Eigen::Vector2f offset;  // [px]
  float inverse_depth;     // [1/m]
};

/// Samples in buckets, for finding the nearest ones.
class SampleGrid {
 public:
  SampleGrid(const PinholeCamera& camera, const std::vector<DepthSample>& samples)
      : columns_(static_cast<int>(std::ceil(static_cast<float>(camera.width) / kBucket))),
        rows_(static_cast<int>(std::ceil(static_cast<float>(camera.height) / kBucket))),
        buckets_(static_cast<std::size_t>(columns_ * rows_)) {
    for (const DepthSample& sample : samples) {
      if (!sample.pixel.allFinite() || !(sample.inverse_depth > 0.0F) || !std::isfinite(sample.inverse_depth)) continue;
      bucket(column(sample.pixel.x()), row(sample.pixel.y())).push_back(sample);
      ++count_;
    }
  }

  std::size_t count() const { return count_; }

  /// The nearest samples, the nearest one first.
  void nearest(const Eigen::Vector2f& pixel, std::vector<Neighbour>& found) const {
    found.clear();
    const int c = column(pixel.x());
    const int r = row(pixel.y());
    const std::size_t wanted = std::min(kNeighbours, count_);
    for (int reach = 1; found.size() < wanted; ++reach) {
      found.clear();
      for (int y = std::max(r - reach, 0); y <= std::min(r + reach, rows_ - 1); ++y) {
        for (int x = std::max(c - reach, 0); x <= std::min(c + reach, columns_ - 1); ++x) {
          for (const DepthSample& sample : buckets_[static_cast<std::size_t>(y * columns_ + x)]) {
            const Eigen::Vector2f offset = sample.pixel - pixel;
            found.push_back({offset.squaredNorm(), offset, sample.inverse_depth});
          }
        }
      }
    }
    std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(wanted), found.end(),
                      [](const Neighbour& a, const Neighbour& b) { return a.squared_distance < b.squared_distance; });
    found.resize(wanted);
  }

 private:
  int column(float x) const { return std::clamp(static_cast<int>(x / kBucket), 0, columns_ - 1); }
  int row(float y) const { return std::clamp(static_cast<int>(y / kBucket), 0, rows_ - 1); }
  std::vector<DepthSample>& bucket(int c, int r) { return buckets_[static_cast<std::size_t>(r * columns_ + c)]; }

  int columns_;
  int rows_;
  std::vector<std::vector<DepthSample>> buckets_;
  std::size_t count_ = 0;
};

float nearness(const Neighbour& n) { return 1.0F / (1.0F + n.squared_distance / (kNear * kNear)); }

/// The weighted median: a surface that most of what is near belongs to.
float medianOf(std::vector<Neighbour> near) {
  std::sort(near.begin(), near.end(),
            [](const Neighbour& a, const Neighbour& b) { return a.inverse_depth < b.inverse_depth; });
  float half = 0.0F;
  for (const Neighbour& n : near) half += 0.5F * nearness(n);
  for (const Neighbour& n : near) {
    half -= nearness(n);
    if (half <= 0.0F) return n.inverse_depth;
  }
  return near.back().inverse_depth;
}

/// Inverse depth at the place around which the neighbours are: a robust fit of a plane.
float fitPlane(const std::vector<Neighbour>& near) {
  const float scale = medianOf(near);
  Eigen::Vector3f plane(0.0F, 0.0F, 1.0F);  // slope and value, relative to `scale`
  Eigen::Matrix3f prior = Eigen::Matrix3f::Zero();
  prior(0, 0) = prior(1, 1) = kNoise * kNoise / (kSlopeSigma * kSlopeSigma);
  float low = 1.0F;
  float high = 1.0F;
  for (int i = 0; i < kIterations; ++i) {
    Eigen::Matrix3f H = prior;
    Eigen::Vector3f b = Eigen::Vector3f::Zero();
    low = high = plane.z();
    for (const Neighbour& n : near) {
      const Eigen::Vector3f J(n.offset.x(), n.offset.y(), 1.0F);
      const float value = n.inverse_depth / scale;
      const float t = (value - J.dot(plane)) / kEdge;
      const float agreement = std::max(0.0F, 1.0F - t * t);
      const float weight = nearness(n) * agreement * agreement;
      if (weight <= 0.0F) continue;
      H += weight * J * J.transpose();
      b += weight * value * J;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (b.z() <= 0.0F) break;
    plane = H.ldlt().solve(b);
  }
  return scale * std::clamp(plane.z(), low - kMostExtrapolation, high + kMostExtrapolation);
}

}  // namespace

cv::Mat1f denseInverseDepth(const PinholeCamera& camera, const std::vector<DepthSample>& samples) {
  const SampleGrid grid(camera, samples);
  if (grid.count() == 0) return {};
  cv::Mat1f cells((camera.height + kCell - 1) / kCell, (camera.width + kCell - 1) / kCell);
  std::vector<Neighbour> near;
  for (int r = 0; r < cells.rows; ++r) {
    for (int c = 0; c < cells.cols; ++c) {
      const Eigen::Vector2f centre = kCell * Eigen::Vector2f(static_cast<float>(c), static_cast<float>(r));
      grid.nearest(centre.array() + 0.5F * (kCell - 1), near);
      cells(r, c) = fitPlane(near);
    }
  }
  cv::medianBlur(cells, cells, 3);
  cv::Mat1f dense;
  cv::resize(cells, dense, cells.size() * kCell, 0.0, 0.0, cv::INTER_LINEAR);
  return dense(cv::Rect(0, 0, camera.width, camera.height)).clone();
}

}  // namespace mba_vo
