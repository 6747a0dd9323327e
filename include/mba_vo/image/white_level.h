#pragma once

#include <opencv2/core.hpp>

namespace mba_vo {

/// The value at which pixels saturate [digital numbers]: 16-bit images hold 10, 12, 14 or 16 bits, and do not say so.
class WhiteLevel {
 public:
  /// `told`: of 16-bit images, 0 = to be found.
  explicit WhiteLevel(double told) : told_(told) {}

  /// Of this image. What is found is the lowest that no value of any image so far exceeds; what it was before, `found`
  /// tells.
  double of(const cv::Mat& image);
  /// 0 = nothing yet.
  double found() const { return found_; }

 private:
  double told_;
  double found_ = 0.0;
};

}  // namespace mba_vo
