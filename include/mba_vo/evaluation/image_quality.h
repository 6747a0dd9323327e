#pragma once

#include <optional>
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
  // Where a second frame could have been used:
  std::optional<long long> second = std::nullopt;  // which one was, counted from this one
  std::string second_reason = {};                  // why none was
  double second_expected_gain = 0.0;               // [dB]
  double second_shift_px = 0.0;                    // against what was expected of it [px]
  double second_residual = 0.0;                    // as residual
  ImageQuality alone = {};                         // without it
  double milliseconds_alone = 0.0;
};

/// deblur.csv: one row per image.
void writeDeblurRecords(const std::vector<DeblurRecord>& records, std::ostream& out);

/// Means by length of the blur, as a table in Markdown.
void writeDeblurTable(const std::vector<DeblurRecord>& records, std::ostream& out);

/// What a second frame gains over one alone, by length of the blur, as a table in Markdown.
void writeSecondFrameTable(const std::vector<DeblurRecord>& records, std::ostream& out);

}  // namespace mba_vo
