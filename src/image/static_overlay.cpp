#include "mba_vo/image/static_overlay.h"

#include <algorithm>
#include <cstdint>

#include <opencv2/imgproc.hpp>

namespace mba_vo {
namespace {

constexpr int kStride = 4;    // every so many images, to be cheap
constexpr int kSamples = 25;  // before anything is believed
constexpr int kRounds = 5;    // samples from one judgement to the next
constexpr int kMemory = 50;   // samples that count: what is no overlay after all is forgotten
// Squared mean of a pixel's gradient over its mean square: 1 if it never changes. Over 25 samples the highest of any
// pixel of desk, shake, kitchen and spin was 0.46; a watermark has 0.9, and over textures more than 0.35 for good.
constexpr float kSteady = 0.7F;
constexpr float kStillSteady = 0.35F;
// [grey levels / 2 px] Less are lamps of one's own, vignettes, and the fixed pattern of the sensor.
constexpr float kLeastEdge = 5.0F;
constexpr int kNeighbourhood = 5;         // [px] in which
constexpr double kLeastNeighbours = 3.0;  // so many gradients have to be steady: a dead pixel makes four
constexpr double kMostShare = 0.25;       // of the image: more is a scene that stands still, however that came about

constexpr int kBlock = 16;        // [px]
constexpr int kBlockRowStep = 2;  // every second row tells enough
// Of a block's energy, what neighbouring gradients have in common: noise has none, images 0.4 to 0.9.
constexpr double kStructured = 0.4;
constexpr int kLeastEnergy = 8 * kBlock * kBlock / kBlockRowStep;  // [squared grey levels / 2 px]
constexpr double kSame = 0.3;  // correlation of a block with itself before, below which it shows something else
// Of the structured blocks. With still scenes, noise and JPEG it was up to 0.24, on sequences 0.8 to 0.98.
constexpr double kMovedShare = 0.6;
constexpr double kLeastBlocks = 0.01;  // of all have to be structured

cv::Mat1b greyOf(const cv::Mat& image, double white_level) {
  cv::Mat grey;
  cv::extractChannel(image, grey, image.channels() == 1 ? 0 : 1);  // of colours, green
  if (grey.depth() == CV_8U) return grey;
  cv::Mat1b eight_bit;
  grey.convertTo(eight_bit, CV_8U, 255.0 / white_level);
  return eight_bit;
}

struct BlockSums {
  int energy_before = 0, energy = 0, common = 0;
  int structure_before = 0;  // products of gradients that share no pixel, and so no noise
};

BlockSums sumBlock(const cv::Mat1b& before, const cv::Mat1b& now, int left, int top) {
  BlockSums sums;
  for (int y = top; y < top + kBlock; y += kBlockRowStep) {
    const std::uint8_t *b = before[y], *b_up = before[y - 1], *b_down = before[y + 1], *b_down2 = before[y + 2];
    const std::uint8_t *n = now[y], *n_up = now[y - 1], *n_down = now[y + 1];
    for (int x = left; x < left + kBlock; ++x) {
      const int bx = b[x + 1] - b[x - 1];
      const int by = b_down[x] - b_up[x];
      const int nx = n[x + 1] - n[x - 1];
      const int ny = n_down[x] - n_up[x];
      sums.energy_before += bx * bx + by * by;
      sums.energy += nx * nx + ny * ny;
      sums.common += bx * nx + by * ny;
      sums.structure_before += bx * (b[x + 2] - b[x]) + by * (b_down2[x] - b[x]);
    }
  }
  return sums;
}

bool isStructured(const BlockSums& sums) {
  return sums.energy_before > kLeastEnergy && sums.structure_before > kStructured * sums.energy_before;
}

bool showsSomethingElse(const BlockSums& sums) {
  if (sums.common <= 0) return true;
  const auto common = static_cast<double>(sums.common);
  return common * common < kSame * kSame * static_cast<double>(sums.energy_before) * sums.energy;
}

}  // namespace

bool StaticOverlay::add(const cv::Mat& image, double white_level) {
  if (images_++ % kStride != 0) return false;
  const cv::Mat1b grey = greyOf(image, white_level);
  if (grey.size() != last_.size()) {
    const bool had_any = !pixels_.empty();
    begin(grey);
    return had_any;
  }
  if (!hasMoved(grey)) return false;
  average(grey);
  last_ = grey;
  return samples_ >= kSamples && samples_ % kRounds == 0 && judge();
}

void StaticOverlay::begin(const cv::Mat1b& image) {
  samples_ = 0;
  last_ = image;
  mean_x_ = cv::Mat1f(image.size(), 0.0F);
  mean_y_ = mean_x_.clone();
  mean_square_ = mean_x_.clone();
  steady_ = cv::Mat1b(image.size(), std::uint8_t{0});
  pixels_.release();
  average(image);
}

/// Since the last sample, everywhere: something that moves before a camera that stands still is not enough.
bool StaticOverlay::hasMoved(const cv::Mat1b& image) const {
  int blocks = 0;
  int structured = 0;
  int moved = 0;
  for (int y = 1; y + kBlock + 1 < image.rows; y += kBlock) {
    for (int x = 1; x + kBlock + 1 < image.cols; x += kBlock) {
      ++blocks;
      const BlockSums sums = sumBlock(last_, image, x, y);
      if (!isStructured(sums)) continue;
      if (!pixels_.empty() && cv::countNonZero(pixels_(cv::Rect(x, y, kBlock, kBlock))) > 0) continue;
      ++structured;
      if (showsSomethingElse(sums)) ++moved;
    }
  }
  return structured > kLeastBlocks * blocks && moved > kMovedShare * structured;
}

void StaticOverlay::average(const cv::Mat1b& image) {
  const float weight = 1.0F / static_cast<float>(std::min(++samples_, kMemory));
  for (int y = 1; y + 1 < image.rows; ++y) {
    const std::uint8_t *row = image[y], *up = image[y - 1], *down = image[y + 1];
    float *mean_x = mean_x_[y], *mean_y = mean_y_[y], *mean_square = mean_square_[y];
    for (int x = 1; x + 1 < image.cols; ++x) {
      const auto gx = static_cast<float>(row[x + 1] - row[x - 1]);
      const auto gy = static_cast<float>(down[x] - up[x]);
      mean_x[x] += weight * (gx - mean_x[x]);
      mean_y[x] += weight * (gy - mean_y[x]);
      mean_square[x] += weight * (gx * gx + gy * gy - mean_square[x]);
    }
  }
}

cv::Mat1b StaticOverlay::steadyPixels() const {
  cv::Mat1b steady(last_.size());
  for (int y = 0; y < steady.rows; ++y) {
    for (int x = 0; x < steady.cols; ++x) {
      const float square = mean_x_(y, x) * mean_x_(y, x) + mean_y_(y, x) * mean_y_(y, x);
      const float least = steady_(y, x) != 0 ? kStillSteady : kSteady;
      const bool is_steady = square > kLeastEdge * kLeastEdge && square > least * mean_square_(y, x);
      steady(y, x) = is_steady ? 255 : 0;
    }
  }
  cv::Mat1f neighbours;
  cv::boxFilter(steady / 255, neighbours, CV_32F, {kNeighbourhood, kNeighbourhood}, {-1, -1}, false);
  steady.setTo(0, neighbours < kLeastNeighbours);
  return steady;
}

/// True if the pixels have changed.
bool StaticOverlay::judge() {
  steady_ = steadyPixels();
  cv::Mat1b pixels;
  cv::dilate(steady_, pixels, cv::Mat());
  const int count = cv::countNonZero(pixels);
  if (count == 0 || count > kMostShare * static_cast<double>(pixels.total())) pixels.release();
  const bool same = pixels.size() == pixels_.size() && (pixels.empty() || cv::countNonZero(pixels != pixels_) == 0);
  if (!same) pixels_ = pixels;
  return !same;
}

double shareOf(const cv::Mat1b& pixels) {
  return pixels.empty() ? 0.0 : cv::countNonZero(pixels) / static_cast<double>(pixels.total());
}

}  // namespace mba_vo
