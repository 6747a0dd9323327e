#include "mba_vo/initialization/initializer_image.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/LU>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "mba_vo/initialization/two_view_geometry.h"

namespace mba_vo {
namespace {

constexpr int kMinWidth = 320;  // [px] of the working level
constexpr int kMaskMargin = 6;  // [px] kept from the border and from invalid pixels
constexpr int kMotionCorners = 140;
constexpr int kMinMotionMatches = 15;
constexpr double kMaxRoundTrip = 1.0;             // [px] forward and back again
constexpr double kHomographyTolerance = 2.0;      // [px]
constexpr int kCornerBlock = 3;                   // [px]
constexpr double kMinCornerGradient = 0.7;        // [grey levels / px] along the weaker direction: above the noise
constexpr double kRelativeCornerQuality = 0.002;  // of the strongest corners

int workingLevel(const ImagePyramid& pyramid) {
  int level = 0;
  while (level + 1 < pyramid.levels() && pyramid.level(level + 1).camera.width >= kMinWidth) ++level;
  return level;
}

/// With the light around them, as far as the flow of a corner looks. The edges of a hole stay where they are, and would
/// hold back the flow of what is next to it.
void fill(const cv::Mat& holes, const cv::Mat& valid, cv::Mat1f& image) {
  constexpr int kSide = 31;             // [px]
  constexpr double kLeastShare = 1e-3;  // of that area
  cv::Mat1f share, light;
  valid.convertTo(share, CV_32F, 1.0 / 255.0);
  cv::blur(share, share, {kSide, kSide});
  cv::blur(image, light, {kSide, kSide});
  light /= cv::max(share, kLeastShare);
  light.setTo(cv::mean(image, valid), share < kLeastShare);
  light.copyTo(image, holes);
}

/// Those at the border of the image: what rectification leaves out, even one pixel wide, is continued where another
/// image is predicted (predictImage), and as black areas would mislead the flow in a third of the image.
cv::Mat holesAtBorder(const cv::Mat& holes) {
  cv::Mat framed, outside;
  cv::copyMakeBorder(holes, framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(255));
  cv::floodFill(framed, {0, 0}, cv::Scalar(128));
  cv::compare(framed(cv::Rect({1, 1}, holes.size())), 128, outside, cv::CMP_EQ);
  return outside;
}

cv::Mat1f blockEnergy(const cv::Mat1b& grey) {
  cv::Mat1f dx, dy;
  cv::Sobel(grey, dx, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(grey, dy, CV_32F, 0, 1, 3, 0.125);
  const cv::Mat energy = dx.mul(dx) + dy.mul(dy);
  const cv::Size blocks(grey.cols / InitializerImage::kBlockSize, grey.rows / InitializerImage::kBlockSize);
  cv::Mat1f mean;
  cv::resize(energy, mean, blocks, 0, 0, cv::INTER_AREA);
  return mean;
}

/// Gradient energy of those blocks of `image` whose centre `H` maps inside the other image.
double commonEnergy(const InitializerImage& image, const Eigen::Matrix3d& H_other_image) {
  constexpr double kHalf = 0.5 * InitializerImage::kBlockSize;
  double sum = 0.0;
  for (int y = 0; y < image.block_energy.rows; ++y) {
    for (int x = 0; x < image.block_energy.cols; ++x) {
      const Eigen::Vector2d centre(InitializerImage::kBlockSize * x + kHalf, InitializerImage::kBlockSize * y + kHalf);
      const bool common = image.camera.contains(applyHomography(H_other_image, centre), kHalf);
      if (common) sum += static_cast<double>(image.block_energy(y, x));
    }
  }
  return sum;
}

struct FlowMatches {
  std::vector<cv::Point2f> previous, next;
};

/// Corners of `previous` that flow to `next` and back to where they came from.
FlowMatches flow(const InitializerImage& previous, const InitializerImage& next, const Eigen::Matrix3d& H_guess) {
  FlowMatches result;
  const std::vector<cv::Point2f> from = selectCorners(previous, kMotionCorners);
  if (from.empty()) return result;
  std::vector<cv::Point2f> to;
  for (const cv::Point2f& p : from) {
    const Eigen::Vector2f q = applyHomography(H_guess, {p.x, p.y}).cast<float>();
    to.emplace_back(q.x(), q.y());
  }
  std::vector<cv::Point2f> back = from;
  std::vector<uchar> found, found_back;
  const cv::Size window(InitializerImage::kFlowWindow, InitializerImage::kFlowWindow);
  const cv::TermCriteria stop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 15, 0.03);
  cv::calcOpticalFlowPyrLK(previous.pyramid, next.pyramid, from, to, found, cv::noArray(), window,
                           InitializerImage::kFlowLevels, stop, cv::OPTFLOW_USE_INITIAL_FLOW, 1e-4);
  cv::calcOpticalFlowPyrLK(next.pyramid, previous.pyramid, to, back, found_back, cv::noArray(), window, 1, stop,
                           cv::OPTFLOW_USE_INITIAL_FLOW, 1e-4);
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!found[i] || !found_back[i] || cv::norm(back[i] - from[i]) > kMaxRoundTrip) continue;
    result.previous.push_back(from[i]);
    result.next.push_back(to[i]);
  }
  return result;
}

}  // namespace

Eigen::Vector2d InitializerImage::toLevel0(const Eigen::Vector2d& pixel) const {
  const double scale = static_cast<double>(1 << level);
  return scale * (pixel.array() + 0.5).matrix() - Eigen::Vector2d(0.5, 0.5);
}

InitializerImageConstPtr makeInitializerImage(const FrameConstPtr& frame) {
  if (!frame || frame->pyramid.levels() < 1) throw std::invalid_argument("initialiser: the frame has no image");
  auto image = std::make_shared<InitializerImage>();
  image->frame = frame;
  image->level = workingLevel(frame->pyramid);
  const ImageLevel& level = frame->pyramid.level(image->level);
  image->camera = level.camera;
  const cv::Mat valid = level.intensity == level.intensity;  // NaN differs from itself
  const cv::Mat holes = ~valid;
  cv::Mat1f finite = level.intensity.clone();
  if (cv::countNonZero(holes) > 0) {
    finite.setTo(0.0F, holes);
    fill(frame->masked ? holes : holesAtBorder(holes), valid, finite);
  }
  finite.convertTo(image->grey, CV_8U);
  const int size = 2 * kMaskMargin + 1;
  cv::erode(valid, image->mask, cv::Mat1b::ones(size, size), cv::Point(-1, -1), 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  const cv::Size window(InitializerImage::kFlowWindow, InitializerImage::kFlowWindow);
  cv::buildOpticalFlowPyramid(image->grey, image->pyramid, window, InitializerImage::kFlowLevels);
  image->block_energy = blockEnergy(image->grey);
  return image;
}

std::vector<cv::Point2f> selectCorners(const InitializerImage& image, int max_count) {
  cv::Mat1f quality;
  cv::cornerMinEigenVal(image.grey, quality, kCornerBlock);
  // OpenCV sums the squares of Sobel (8 x gradient) / (4 x block x 255) over the block.
  const double gradient_scale = 8.0 / (4.0 * kCornerBlock * 255.0);
  double threshold = std::pow(gradient_scale * kMinCornerGradient * kCornerBlock, 2);
  const double area = static_cast<double>(image.grey.total());
  const int cell = std::max(4, static_cast<int>(std::sqrt(area / (1.5 * max_count))));
  struct Corner {
    cv::Point2f pixel;
    float quality;
  };
  std::vector<Corner> corners;
  for (int y = 0; y + cell <= image.grey.rows; y += cell) {
    for (int x = 0; x + cell <= image.grey.cols; x += cell) {
      const cv::Rect area_of_cell(x, y, cell, cell);
      double best = 0.0;
      cv::Point at;
      cv::minMaxLoc(quality(area_of_cell), nullptr, &best, nullptr, &at, image.mask(area_of_cell));
      if (best > threshold) corners.push_back({cv::Point2f(at + area_of_cell.tl()), static_cast<float>(best)});
    }
  }
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.quality > b.quality; });
  if (corners.size() > 10) threshold = kRelativeCornerQuality * static_cast<double>(corners[5].quality);
  std::vector<cv::Point2f> pixels;
  for (const Corner& corner : corners) {
    const bool good = static_cast<double>(corner.quality) > threshold;
    if (good && static_cast<int>(pixels.size()) < max_count) pixels.push_back(corner.pixel);
  }
  return pixels;
}

ImageMotion measureMotion(const InitializerImage& previous, const InitializerImage& next,
                          const Eigen::Vector3d& guess) {
  ImageMotion motion;
  motion.rotation = guess;
  motion.H_next_previous = rotationHomography(previous.camera, guess);
  const FlowMatches matches = flow(previous, next, motion.H_next_previous);
  if (static_cast<int>(matches.previous.size()) < kMinMotionMatches) return motion;
  std::vector<uchar> inliers;
  const cv::Mat H = cv::findHomography(matches.previous, matches.next, cv::RANSAC, kHomographyTolerance, inliers, 300);
  if (H.empty()) return motion;
  PixelMatches kept;
  for (std::size_t i = 0; i < inliers.size(); ++i) {
    if (!inliers[i]) continue;
    kept.add({matches.previous[i].x, matches.previous[i].y}, {matches.next[i].x, matches.next[i].y});
  }
  if (static_cast<int>(kept.size()) < kMinMotionMatches) return motion;
  cv::cv2eigen(H, motion.H_next_previous);
  motion.rotation = fitRotation(previous.camera, kept, guess).rotation;
  const double before = commonEnergy(previous, motion.H_next_previous);
  const double after = commonEnergy(next, motion.H_next_previous.inverse());
  if (before > 0.0 && after > 0.0) motion.sharpness_gain = std::log(after / before);
  motion.measured = true;
  return motion;
}

Eigen::Matrix3d rotationHomography(const PinholeCamera& camera, const Eigen::Vector3d& rotation) {
  Eigen::Matrix3d K;
  K << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
  const double angle = rotation.norm();
  if (angle < 1e-12) return Eigen::Matrix3d::Identity();
  return K * Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix() * K.inverse();
}

Eigen::Vector2d applyHomography(const Eigen::Matrix3d& H, const Eigen::Vector2d& pixel) {
  return (H * pixel.homogeneous()).hnormalized();
}

}  // namespace mba_vo
