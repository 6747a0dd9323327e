#include "mba_vo/image/repeat_detector.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace mba_vo {
namespace {

constexpr int kSide = 16;    // [px] of squares, whose means a codec keeps and any motion changes
constexpr int kRowStep = 2;  // every second row tells enough
constexpr double kPixels = kSide * kSide / kRowStep;
// [grey levels] of such a mean. JPEG rounds the means of its 8x8 blocks to 0.25 (quality 95) to 2 (50); measured on
// desk, kitchen and phone, recompression at 60 to 95 changes one by up to 1.2, and motion at least one by 5 or more.
constexpr double kLargestShift = 1.25;
constexpr double kLargestNoise = 6.0;  // standard deviations of a mean by noise alone
constexpr double kBelowNoise = 0.5;    // of the noise; that of a standing camera varies by a few per cent
constexpr std::size_t kStanding = 3;   // so many small differences in a row are those of a standing camera
constexpr double kForgetting = 1.01;   // of the noise with each image: it changes with the gain
// Share of the differences that a shift of each square explains: 0.02 by chance. Measured: 0.02 to 0.05 where images of
// desk, kitchen and phone were compressed again (60 to 95), 0.3 or more where texture as fine as pixels moves slowly.
constexpr double kShift = 0.15;
constexpr double kMoved = std::numeric_limits<double>::infinity();

bool areSameBytes(const cv::Mat& a, const cv::Mat& b) {
  const std::size_t bytes = static_cast<std::size_t>(a.cols) * a.elemSize();
  for (int y = 0; y < a.rows; ++y) {
    if (std::memcmp(a.ptr(y), b.ptr(y), bytes) != 0) return false;
  }
  return true;
}

struct Sums {
  int sum = 0;
  int squares = 0;
};

/// Of the differences in a square.
Sums sumSquare(const cv::Mat1b& a, const cv::Mat1b& b, int x, int y) {
  Sums sums;
  for (int row = y; row < y + kSide; row += kRowStep) {
    const std::uint8_t* l = a[row] + x;
    const std::uint8_t* r = b[row] + x;
    for (int i = 0; i < kSide; ++i) {
      const int d = l[i] - r[i];
      sums.sum += d;
      sums.squares += d * d;
    }
  }
  return sums;
}

/// Root mean square of the differences; kMoved if the mean of a square differs by more than noise and codecs explain.
double differenceOf(const cv::Mat1b& a, const cv::Mat1b& b) {
  double squares = 0.0;
  int largest = 0;
  int count = 0;
  for (int y = 0; y + kSide <= a.rows; y += kSide) {
    for (int x = 0; x + kSide <= a.cols; x += kSide) {
      const Sums sums = sumSquare(a, b, x, y);
      squares += sums.squares;
      largest = std::max(largest, std::abs(sums.sum));
      ++count;
    }
  }
  if (count == 0) return kMoved;
  const double rms = std::sqrt(squares / (kPixels * count));
  const double limit = std::max(kLargestShift, kLargestNoise * rms / std::sqrt(kPixels));
  return largest > limit * kPixels ? kMoved : rms;
}

/// How differences and gradients of a square go together.
struct GradientSums {
  double xx = 0.0, xy = 0.0, yy = 0.0, xd = 0.0, yd = 0.0, dd = 0.0;

  void add(double gx, double gy, double d) {
    xx += gx * gx;
    xy += gx * gy;
    yy += gy * gy;
    xd += gx * d;
    yd += gy * d;
    dd += d * d;
  }
  /// What of the squared differences the best shift explains.
  double explained() const {
    const double determinant = xx * yy - xy * xy;
    constexpr double kSingular = 1e-6;  // of the square of the trace: one edge, or nothing
    if (determinant <= kSingular * (xx + yy) * (xx + yy)) return xx + yy > 0.0 ? (xd * xd + yd * yd) / (xx + yy) : 0.0;
    return (xd * xd * yy - 2.0 * xd * yd * xy + yd * yd * xx) / determinant;
  }
};

/// Share of the differences that is explained by motion, by one of its own in each square. `step` [bytes] from pixel to
/// pixel. With the gradient of both images, so that noise explains none.
double shareOfShift(const cv::Mat1b& a, const cv::Mat1b& b, int step) {
  double explained = 0.0;
  double all = 0.0;
  for (int y = 1; y + kSide < a.rows; y += kSide) {
    for (int x = step; x + kSide + step <= a.cols; x += kSide) {
      GradientSums sums;
      for (int row = y; row < y + kSide; row += kRowStep) {
        const auto both = [&](int r, int c) { return a(r, c) + b(r, c); };
        for (int c = x; c < x + kSide; ++c) {
          sums.add(both(row, c + step) - both(row, c - step), both(row + 1, c) - both(row - 1, c),
                   a(row, c) - b(row, c));
        }
      }
      explained += sums.explained();
      all += sums.dd;
    }
  }
  return all > 0.0 ? explained / all : 0.0;
}

}  // namespace

void RepeatDetector::ignore(const cv::Mat1b& unused) { unused_ = unused; }

bool RepeatDetector::isRepeat(const cv::Mat& image) {
  if (image.size() != original_.size() || image.type() != original_.type()) {
    reset();
    image.copyTo(original_);
    return false;
  }
  const cv::Mat now = usedPixels(image);
  const cv::Mat before = usedPixels(original_);
  if (areSameBytes(now, before)) return true;  // noise included: no camera takes the same image twice
  // Streams that are compressed have 8 bits. Channels side by side are as good as pixels.
  const bool comparable = image.depth() == CV_8U && image.isContinuous();
  const double difference = comparable ? differenceOf(now.reshape(1), before.reshape(1)) : kMoved;
  // Where fine texture moves fast, what looks like noise is texture, and slower motion is less of it.
  const bool repeat =
      isBelowNoise(difference) && shareOfShift(now.reshape(1), before.reshape(1), image.channels()) < kShift;
  learn(difference);
  if (!repeat) image.copyTo(original_);
  return repeat;
}

/// 0 where they are not used.
cv::Mat RepeatDetector::usedPixels(const cv::Mat& image) const {
  if (unused_.size() != image.size()) return image;
  cv::Mat used = image.clone();
  used.setTo(0, unused_);
  return used;
}

/// The noise of the sensor is in the difference of any two exposures, also where nothing moves. Until it is known, the
/// image before must have moved: a camera that stops shows it soon, and has the pose of the first image until then.
bool RepeatDetector::isBelowNoise(double difference) const {
  return differences_.size() == kStanding && difference < kBelowNoise * noise_;
}

void RepeatDetector::learn(double difference) {
  differences_.push_back(difference);
  if (differences_.size() > kStanding) differences_.pop_front();
  if (differences_.size() < kStanding) return;
  noise_ = std::min(kForgetting * noise_, *std::max_element(differences_.begin(), differences_.end()));
}

void RepeatDetector::reset() {
  original_.release();
  differences_.clear();
  noise_ = kMoved;
}

}  // namespace mba_vo
