#include "mba_vo/evaluation/image_quality.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>

#include <opencv2/imgproc.hpp>

namespace mba_vo {
namespace {

constexpr double kPeak = 255.0;  // [grey levels]

cv::Mat1f smooth(const cv::Mat1f& image) {
  constexpr int kSsimWindow = 11;  // [px]
  constexpr double kSigma = 1.5;   // [px]
  cv::Mat1f result;
  cv::GaussianBlur(image, result, {kSsimWindow, kSsimWindow}, kSigma, kSigma, cv::BORDER_REFLECT);
  return result;
}

cv::Mat1f times(const cv::Mat1f& a, const cv::Mat1f& b) {
  cv::Mat1f result;
  cv::multiply(a, b, result);
  return result;
}

/// Invalid pixels are made equal in both, and counted out.
double structuralSimilarity(const cv::Mat1f& a, const cv::Mat1f& b, const cv::Mat1b& valid) {
  constexpr double kC1 = 0.01 * kPeak * 0.01 * kPeak;
  constexpr double kC2 = 0.03 * kPeak * 0.03 * kPeak;
  const cv::Mat1f mean_a = smooth(a);
  const cv::Mat1f mean_b = smooth(b);
  const cv::Mat1f product = times(mean_a, mean_b);
  const cv::Mat1f squares(times(mean_a, mean_a) + times(mean_b, mean_b));
  const cv::Mat1f covariance(smooth(times(a, b)) - product);
  const cv::Mat1f variances(smooth(times(a, a)) + smooth(times(b, b)) - squares);
  const cv::Mat1f above((2.0 * product + kC1).mul(2.0 * covariance + kC2));
  const cv::Mat1f below((squares + kC1).mul(variances + kC2));
  return cv::mean(above / below, valid)[0];
}

struct BlurRange {
  double from, to;  // [px]
};
constexpr BlurRange kRanges[] = {{0.0, 4.0}, {4.0, 8.0}, {8.0, 20.0}, {20.0, 45.0}, {45.0, 1e9}};

/// Sums over the images of one range.
struct RangeSums {
  int images = 0, sharpened = 0, measured = 0;
  double psnr_before = 0.0, psnr_after = 0.0, ssim_before = 0.0, ssim_after = 0.0;
  double worst = std::numeric_limits<double>::infinity();  // gain of a sharpened image [dB]
  double milliseconds = 0.0;

  void add(const DeblurRecord& record) {
    ++images;
    if (record.sharpened) {
      ++sharpened;
      milliseconds += record.milliseconds;
    }
    if (!record.measured) return;
    ++measured;
    psnr_before += record.before.psnr;
    psnr_after += record.after.psnr;
    ssim_before += record.before.ssim;
    ssim_after += record.after.ssim;
    if (record.sharpened) worst = std::min(worst, record.after.psnr - record.before.psnr);
  }
};

void writeRange(const BlurRange& range, std::ostream& out) {
  out << "| " << std::setprecision(1) << range.from << (range.to < 1e8 ? " to " : " and more");
  if (range.to < 1e8) out << range.to;
}

void writeRow(const BlurRange& range, const RangeSums& sums, std::ostream& out) {
  writeRange(range, out);
  out << " | " << sums.images << " | " << sums.sharpened << " | ";
  const double n = sums.measured;
  if (sums.measured == 0) {
    out << "| | | | | ";
  } else {
    out << std::setprecision(2) << sums.psnr_before / n << " | " << sums.psnr_after / n << " | "
        << (sums.psnr_after - sums.psnr_before) / n << " | ";
    if (std::isfinite(sums.worst)) out << sums.worst;
    out << " | " << std::setprecision(3) << sums.ssim_before / n << " | " << sums.ssim_after / n << " | ";
  }
  out << std::setprecision(0);
  if (sums.sharpened > 0) out << sums.milliseconds / sums.sharpened;
  out << " |\n";
}

/// Sums over those images of one range for which a second frame was used, but for `gain_one` and `gain`.
struct SecondFrameSums {
  int images = 0, used = 0;
  double gain_one = 0.0, gain = 0.0;  // of all images [dB]
  double used_one = 0.0, used_two = 0.0;
  double least = std::numeric_limits<double>::infinity();  // gain of two over one [dB]
  double ssim_one = 0.0, ssim_two = 0.0;
  double milliseconds_one = 0.0, milliseconds_two = 0.0;

  void add(const DeblurRecord& r) {
    if (!r.measured) return;
    ++images;
    const double two = r.after.psnr - r.before.psnr;
    const double one = r.second ? r.alone.psnr - r.before.psnr : two;
    gain_one += one;
    gain += two;
    if (!r.second) return;
    ++used;
    used_one += one;
    used_two += two;
    least = std::min(least, two - one);
    ssim_one += r.alone.ssim;
    ssim_two += r.after.ssim;
    milliseconds_one += r.milliseconds_alone;
    milliseconds_two += r.milliseconds;
  }
};

void writeRow(const BlurRange& range, const SecondFrameSums& sums, std::ostream& out) {
  writeRange(range, out);
  const double n = sums.images;
  out << " | " << sums.images << std::setprecision(2) << " | " << sums.gain_one / n << " | " << sums.gain / n << " | "
      << sums.used << " | ";
  if (sums.used == 0) {
    out << "| | | | | | |\n";
    return;
  }
  const double m = sums.used;
  out << sums.used_one / m << " | " << sums.used_two / m << " | " << sums.least << " | " << std::setprecision(3)
      << sums.ssim_one / m << " | " << sums.ssim_two / m << " | " << std::setprecision(0) << sums.milliseconds_one / m
      << " | " << sums.milliseconds_two / m << " |\n";
}

void writeSecond(const DeblurRecord& r, std::ostream& out) {
  if (r.second) out << *r.second;
  out << ',' << r.second_reason << std::setprecision(2) << ',' << r.second_expected_gain << ',' << r.second_shift_px
      << ',' << r.second_residual << ',';
  if (r.second) {
    if (r.measured) out << std::setprecision(3) << r.alone.psnr << ',' << std::setprecision(4) << r.alone.ssim;
    if (!r.measured) out << ',';
    out << ',' << std::setprecision(1) << r.milliseconds_alone << '\n';
  } else {
    out << ",,\n";
  }
}

}  // namespace

ImageQuality compareImages(const cv::Mat1f& image, const cv::Mat1f& truth) {
  const cv::Mat1b valid((image == image) & (truth == truth));
  cv::Mat1f a(image.size(), 0.0F);
  cv::Mat1f b(image.size(), 0.0F);
  image.copyTo(a, valid);
  truth.copyTo(b, valid);
  const double squared = cv::norm(a, b, cv::NORM_L2SQR) / std::max(1, cv::countNonZero(valid));
  return {10.0 * std::log10(kPeak * kPeak / std::max(squared, 1e-9)), structuralSimilarity(a, b, valid)};
}

void writeDeblurRecords(const std::vector<DeblurRecord>& records, std::ostream& out) {
  out << "image,blur_px,sharpened,reason,residual,milliseconds,psnr_before,psnr_after,ssim_before,ssim_after,"
         "second,second_reason,second_expected_gain,second_shift_px,second_residual,psnr_alone,ssim_alone,"
         "milliseconds_alone\n"
      << std::fixed;
  for (const DeblurRecord& r : records) {
    out << r.name << ',' << std::setprecision(2) << r.blur_px << ',' << (r.sharpened ? 1 : 0) << ',' << r.reason << ','
        << std::setprecision(3) << r.residual << ',' << std::setprecision(1) << r.milliseconds << ',';
    if (r.measured) {
      out << std::setprecision(3) << r.before.psnr << ',' << r.after.psnr << ',' << std::setprecision(4)
          << r.before.ssim << ',' << r.after.ssim << ',';
    } else {
      out << ",,,,";
    }
    writeSecond(r, out);
  }
}

void writeDeblurTable(const std::vector<DeblurRecord>& records, std::ostream& out) {
  out << "| blur [px] | images | sharpened | PSNR before [dB] | after | gain | worst gain | SSIM before | after | "
         "time [ms] |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n"
      << std::fixed;
  for (const BlurRange& range : kRanges) {
    RangeSums sums;
    for (const DeblurRecord& record : records) {
      if (record.blur_px >= range.from && record.blur_px < range.to) sums.add(record);
    }
    if (sums.images > 0) writeRow(range, sums, out);
  }
}

void writeSecondFrameTable(const std::vector<DeblurRecord>& records, std::ostream& out) {
  out << "| blur [px] | images | gain, one frame [dB] | gain, up to two | with a second frame | their gain with one | "
         "with two | least, two over one | SSIM with one | with two | time with one [ms] | with two |\n"
         "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n"
      << std::fixed;
  for (const BlurRange& range : kRanges) {
    SecondFrameSums sums;
    for (const DeblurRecord& record : records) {
      if (record.blur_px >= range.from && record.blur_px < range.to) sums.add(record);
    }
    if (sums.images > 0) writeRow(range, sums, out);
  }
}

}  // namespace mba_vo
