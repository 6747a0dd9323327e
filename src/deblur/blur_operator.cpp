#include "mba_vo/deblur/blur_operator.h"

#include <algorithm>
#include <cmath>

#include "mba_vo/image/multiversion.h"
#include "tap_accumulator.h"

namespace mba_vo {
namespace {

constexpr int kTile = BlurOperator::kTile;
constexpr float kSpacing = 0.5F;  // of samples along a path [px]

/// A row of a tile, wherever it begins in memory.
using Lanes [[gnu::vector_size(kTile * sizeof(float)), gnu::aligned(4), gnu::may_alias]] = float;

int roundUp(int n) { return (n + kTile - 1) / kTile * kTile; }

}  // namespace

class BlurOperator::Builder {
 public:
  Builder(const BlurGeometry& geometry, const cv::Mat1f& inverse_depth, BlurOperator& out)
      : size_(geometry.latent_camera.width, geometry.latent_camera.height),
        inverse_depth_(inverse_depth),
        maker_(geometry),
        out_(out) {}

  void build() {
    for (int y = 0; y < size_.height; y += kTile) {
      for (int x = 0; x < size_.width; x += kTile) addTile(x, y);
    }
  }

 private:
  void addTile(int x, int y) {
    constexpr float kCentre = 0.5F * (kTile - 1);
    const Eigen::Vector2f centre(static_cast<float>(x) + kCentre, static_cast<float>(y) + kCentre);
    LatentPath seen;
    if (!maker_.make(centre.cast<double>(), static_cast<double>(depthAt(centre)), seen)) return;
    const PatchPath& path = seen.path;
    const int samples = std::max(1, static_cast<int>(std::ceil(path.length() / kSpacing)));
    const auto shift = [&](int i) {
      const float u = (static_cast<float>(i) + 0.5F) / static_cast<float>(samples) - 0.5F;
      return Eigen::Vector2f(path.c0 + u * (path.c1 + u * path.c2) - centre);
    };
    Eigen::Vector2f low = shift(0);
    Eigen::Vector2f high = low;
    for (int i = 1; i < samples; ++i) {
      low = low.cwiseMin(shift(i));
      high = high.cwiseMax(shift(i));
    }
    accumulator_.begin(low, high);
    for (int i = 0; i < samples; ++i) accumulator_.add(shift(i), 1.0F / static_cast<float>(samples));
    collect(x, y);
  }

  float depthAt(const Eigen::Vector2f& pixel) const {
    const float x = std::clamp(pixel.x(), 0.0F, static_cast<float>(inverse_depth_.cols - 1));
    const float y = std::clamp(pixel.y(), 0.0F, static_cast<float>(inverse_depth_.rows - 1));
    return inverse_depth_(static_cast<int>(std::lround(y)), static_cast<int>(std::lround(x)));
  }

  void collect(int x, int y) {
    const int margin = out_.grid_.margin;
    const cv::Size size = out_.grid_.size;
    if (!accumulator_.inside(-margin - x, -margin - y, size.width - margin - kTile - x,
                             size.height - margin - kTile - y)) {
      return;
    }
    Tile tile{};
    tile.pixel = y * out_.observed_.width + x;
    tile.origin = (y + margin) * size.width + x + margin;
    tile.first_tap = static_cast<std::int32_t>(out_.taps_.size());
    accumulator_.forEach([&](int dx, int dy, float weight) { out_.taps_.push_back({dy * size.width + dx, weight}); });
    tile.taps = static_cast<std::int32_t>(out_.taps_.size()) - tile.first_tap;
    out_.tiles_.push_back(tile);
    out_.seen_(cv::Rect(x, y, kTile, kTile) & cv::Rect({0, 0}, size_)).setTo(1.0F);
  }

  cv::Size size_;
  const cv::Mat1f& inverse_depth_;
  LatentPathMaker maker_;
  BlurOperator& out_;
  TapAccumulator accumulator_;
};

BlurOperator::BlurOperator(const BlurGeometry& geometry, const cv::Mat1f& inverse_depth, const LatentGrid& grid)
    : grid_(grid),
      observed_(roundUp(geometry.latent_camera.width), roundUp(geometry.latent_camera.height)),
      seen_(observed_, 0.0F) {
  Builder(geometry, inverse_depth, *this).build();
}

LatentGrid BlurOperator::gridFor(const PinholeCamera& latent_camera, int reach_px) {
  const int margin = reach_px + kTile;
  return {margin, {roundUp(latent_camera.width) + 2 * margin, roundUp(latent_camera.height) + 2 * margin}};
}

float BlurOperator::noiseGain() const {
  double sum = 0.0;
  for (const Tap& tap : taps_) sum += static_cast<double>(tap.weight * tap.weight);
  return tiles_.empty() ? 1.0F : static_cast<float>(sum / static_cast<double>(tiles_.size()));
}

void BlurOperator::apply(const cv::Mat1f& latent, cv::Mat1f& blurred) const {
  blurred.create(observed_);
  blurred.setTo(0.0F);
  applyTiles(latent[0], blurred[0]);
}

void BlurOperator::addTransposed(const cv::Mat1f& blurred, cv::Mat1f& latent) const {
  addTilesTransposed(blurred[0], latent[0]);
}

MBA_VO_MULTIVERSION
void BlurOperator::applyTiles(const float* latent, float* blurred) const {
  const int stride = grid_.size.width;
  for (const Tile& tile : tiles_) {
    const float* source = latent + tile.origin;
    Lanes sum[kTile] = {};
    for (int t = tile.first_tap; t < tile.first_tap + tile.taps; ++t) {
      const Tap tap = taps_[static_cast<std::size_t>(t)];
      const float* row = source + tap.offset;
      for (int y = 0; y < kTile; ++y, row += stride) sum[y] += tap.weight * *reinterpret_cast<const Lanes*>(row);
    }
    float* target = blurred + tile.pixel;
    for (int y = 0; y < kTile; ++y, target += observed_.width) *reinterpret_cast<Lanes*>(target) = sum[y];
  }
}

MBA_VO_MULTIVERSION
void BlurOperator::addTilesTransposed(const float* blurred, float* latent) const {
  const int stride = grid_.size.width;
  for (const Tile& tile : tiles_) {
    const float* source = blurred + tile.pixel;
    Lanes value[kTile];
    for (int y = 0; y < kTile; ++y, source += observed_.width) value[y] = *reinterpret_cast<const Lanes*>(source);
    float* target = latent + tile.origin;
    for (int t = tile.first_tap; t < tile.first_tap + tile.taps; ++t) {
      const Tap tap = taps_[static_cast<std::size_t>(t)];
      float* row = target + tap.offset;
      for (int y = 0; y < kTile; ++y, row += stride) *reinterpret_cast<Lanes*>(row) += tap.weight * value[y];
    }
  }
}

}  // namespace mba_vo
