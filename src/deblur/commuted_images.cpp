#include "mba_vo/deblur/commuted_images.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace mba_vo {
namespace {

constexpr int kAround = 9;             // window in which the images are compared [px]
constexpr float kAlmostAll = 0.999F;   // of a path's weight
constexpr float kFewestKnown = 0.05F;  // of a window

/// An image as if it were a sharp one, its border continued.
cv::Mat1f onGrid(const cv::Mat1f& image, const LatentGrid& grid) {
  cv::Mat1f result;
  cv::copyMakeBorder(image, result, grid.margin, grid.size.height - grid.margin - image.rows, grid.margin,
                     grid.size.width - grid.margin - image.cols, cv::BORDER_REPLICATE);
  return result;
}

/// 1 where the whole path is over pixels with a weight.
cv::Mat1f knownAfter(const BlurOperator& blur, const Observation& image) {
  const cv::Mat1b weighted(image.data().weight > 0.0F);
  cv::Mat1f known;
  weighted.convertTo(known, CV_32F, 1.0 / 255.0);
  cv::Mat1f blurred;
  blur.apply(onGrid(known, blur.grid()), blurred);
  cv::threshold(blurred, blurred, static_cast<double>(kAlmostAll), 1.0, cv::THRESH_BINARY);
  return blurred;
}

}  // namespace

CommutedImages commute(const Observation& keyframe, const Observation& neighbour) {
  CommutedImages result;
  result.keyframe_gain = keyframe.blur().noiseGain();
  result.neighbour_gain = neighbour.blur().noiseGain();
  neighbour.blur().apply(onGrid(keyframe.data().image, keyframe.blur().grid()), result.keyframe);
  keyframe.blur().apply(onGrid(neighbour.data().image, keyframe.blur().grid()), result.neighbour);
  result.known = knownAfter(neighbour.blur(), keyframe).mul(knownAfter(keyframe.blur(), neighbour));
  return result;
}

cv::Mat1f modelVariance(const CommutedImages& images, float keyframe_noise, float neighbour_noise) {
  const cv::Mat1f difference(images.keyframe - images.neighbour);
  cv::Mat1f squares(difference.mul(difference).mul(images.known));
  cv::Mat1f known;
  const cv::Size window(kAround, kAround);
  cv::boxFilter(squares, squares, CV_32F, window);
  cv::boxFilter(images.known, known, CV_32F, window);
  const float noise = keyframe_noise * keyframe_noise * images.neighbour_gain +
                      neighbour_noise * neighbour_noise * images.keyframe_gain;
  cv::Mat1f variance(squares.size());
  for (int y = 0; y < squares.rows; ++y) {
    for (int x = 0; x < squares.cols; ++x) {
      variance(y, x) = std::max(0.0F, squares(y, x) / std::max(kFewestKnown, known(y, x)) - noise);
    }
  }
  return variance;
}

}  // namespace mba_vo
