#pragma once

#include <ostream>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace mba_vo {

/// How alike two images are, over the pixels that are valid (no NaN) in both.
struct ImageQuality {
  double psnr = 0.0;  // peak signal to noise, peak 255 [dB]
  double ssim = 0.0;  // mean structural similarity (Wang et al. 2004: Gaussian window, sigma 1.5)
};

ImageQuality compareImages(const cv::Mat1f& image, const cv::Mat1f& truth);

/// One deblurred image.
struct DeblurRecord {
  std::string name;
  double blur_px = 0.0;  // [px]
  bool sharpened = false;
  std::string reason;     // why not
  double residual = 0.0;  // result blurred again minus input [standard deviations]
  double milliseconds = 0.0;
  bool measured = false;  // against a sharp image
  ImageQuality before, after;
};

/// deblur.csv: one row per image.
void writeDeblurRecords(const std::vector<DeblurRecord>& records, std::ostream& out);

/// Means by length of the blur, as a table in Markdown.
void writeDeblurTable(const std::vector<DeblurRecord>& records, std::ostream& out);

}  // namespace mba_vo
