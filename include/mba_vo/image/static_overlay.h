#pragma once

#include <opencv2/core.hpp>

namespace mba_vo {

/// Finds what stays where it is in the images while the scene moves: a watermark, dead and stuck pixels, parts of what
/// carries the camera. It is told by gradients that stay the same in direction and size; flat areas tell nothing, and
/// need no mask. While the camera stands still, nothing is learnt.
class StaticOverlay {
 public:
  /// `image`: the camera's, 8-bit, or 16-bit and white at `white_level`. Of some only. True if pixels() has changed.
  bool add(const cv::Mat& image, double white_level);

  /// 255 where something covers the scene; empty if nothing does. Not written any more once it is returned.
  const cv::Mat1b& pixels() const { return pixels_; }

 private:
  void begin(const cv::Mat1b& image);
  bool hasMoved(const cv::Mat1b& image) const;
  void average(const cv::Mat1b& image);
  cv::Mat1b steadyPixels() const;
  bool judge();

  int images_ = 0;
  int samples_ = 0;
  cv::Mat1b last_;             // sample
  cv::Mat1f mean_x_, mean_y_;  // gradient [grey levels / 2 px]
  cv::Mat1f mean_square_;      // of it
  cv::Mat1b steady_;           // gradients that were found not to move
  cv::Mat1b pixels_;
};

/// Share of the image that is not 0.
double shareOf(const cv::Mat1b& pixels);

}  // namespace mba_vo
