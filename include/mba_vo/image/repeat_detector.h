#pragma once

#include <deque>
#include <limits>

#include <opencv2/core.hpp>

namespace mba_vo {

/// Tells images that show the same exposure as an earlier one: a recorder or a stream has sent it again, to the byte,
/// or compressed once more.
class RepeatDetector {
 public:
  /// True if `image`, 8- or 16-bit, shows what the last image did that repeated none.
  bool isRepeat(const cv::Mat& image);
  /// Pixels that are not 0 in `unused` tell nothing from now on; empty: all of them tell.
  void ignore(const cv::Mat1b& unused);
  void reset();

 private:
  cv::Mat usedPixels(const cv::Mat& image) const;
  bool isBelowNoise(double difference) const;
  void learn(double difference);

  cv::Mat1b unused_;
  cv::Mat original_;                // a copy
  std::deque<double> differences_;  // of the newest images from the original then [grey levels], infinite if moved
  double noise_ = std::numeric_limits<double>::infinity();  // in the difference of two exposures [grey levels]
};

}  // namespace mba_vo
