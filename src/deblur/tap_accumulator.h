#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace mba_vo {

/// Collects the weights that samples between pixels leave on the pixels around them.
class TapAccumulator {
 public:
  /// Of an area that holds every sample between `low` and `high` [px].
  void begin(const Eigen::Vector2f& low, const Eigen::Vector2f& high);
  void add(const Eigen::Vector2f& position, float weight);

  bool inside(int min_x, int min_y, int max_x, int max_y) const {
    return x_ >= min_x && y_ >= min_y && x_ + width_ - 1 <= max_x && y_ + height_ - 1 <= max_y;
  }
  /// Calls visit(x, y, weight) for all pixels with a weight.
  template <typename Visitor>
  void forEach(const Visitor& visit) const {
    const float* weight = weights_.data();
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x, ++weight) {
        if (*weight != 0.0F) visit(x_ + x, y_ + y, *weight);
      }
    }
  }

 private:
  int x_ = 0;
  int y_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::vector<float> weights_;
};

}  // namespace mba_vo
