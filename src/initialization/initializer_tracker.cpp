#include "mba_vo/initialization/initializer_tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace mba_vo {
namespace {

constexpr double kBlurSpacing = 1.5;  // [px] between samples along the blur
constexpr int kMaxBlurSamples = 12;
constexpr double kMaxTrackRoundTrip = 0.5;  // [px] forward and back again
constexpr int kMinHomographyTracks = 20;
constexpr double kTrackTolerance = 3.0;  // [px]; parallax is no outlier
constexpr double kMargin = 4.0;          // [px]
constexpr int kWindow = 17;              // [px]
constexpr int kAreasAcross = 8;          // wide enough to leave what is tracked, small enough for a vignette
constexpr double kLeastShare = 0.1;      // of an area that both images see
constexpr int kLevels = 2;               // above level 0

/// Longest path of a pixel during the exposure [px].
double blurLength(const PinholeCamera& camera, const Eigen::Vector3d& exposure_rotation) {
  const Eigen::Matrix3d H = rotationHomography(camera, exposure_rotation);
  double length = 0.0;
  for (const double x : {0.0, 0.5 * camera.width, 1.0 * camera.width}) {
    for (const double y : {0.0, 0.5 * camera.height, 1.0 * camera.height}) {
      length = std::max(length, (applyHomography(H, {x, y}) - Eigen::Vector2d(x, y)).norm());
    }
  }
  return length;
}

cv::Mat warp(const cv::Mat1b& image, const Eigen::Matrix3d& H, int border = cv::BORDER_REPLICATE) {
  cv::Mat h, warped;
  cv::eigen2cv(H, h);
  cv::warpPerspective(image, warped, h, image.size(), cv::INTER_LINEAR, border);
  return warped;
}

/// The reference as `camera` would see it: warped by H, averaged over the exposure at mid-points u = (i + 1/2)/n - 1/2.
cv::Mat1f predictImage(const InitializerImage& reference, const Eigen::Matrix3d& H_image_reference,
                       const Eigen::Vector3d& exposure_rotation) {
  const double length = blurLength(reference.camera, exposure_rotation);
  const int n = std::clamp(static_cast<int>(std::lround(length / kBlurSpacing)), 1, kMaxBlurSamples);
  cv::Mat1f sum(reference.grey.size(), 0.0F);
  for (int i = 0; i < n; ++i) {
    const double u = (i + 0.5) / n - 0.5;
    const Eigen::Matrix3d H = rotationHomography(reference.camera, u * exposure_rotation) * H_image_reference;
    cv::accumulate(warp(reference.grey, H), sum);
  }
  sum *= 1.0 / n;
  return sum;
}

/// Gives `prediction` the gain and offset of `image`, measured around the predicted corners.
void matchBrightness(const InitializerImage& image, const std::vector<cv::Point2f>& at, cv::Mat1f& prediction) {
  double sp = 0.0, si = 0.0, spp = 0.0, sii = 0.0, n = 0.0;
  for (const cv::Point2f& p : at) {
    for (int dy = -6; dy <= 6; dy += 3) {
      for (int dx = -6; dx <= 6; dx += 3) {
        const cv::Point q(cvRound(p.x) + dx, cvRound(p.y) + dy);
        if (q.x < 0 || q.y < 0 || q.x >= image.grey.cols || q.y >= image.grey.rows) continue;
        const auto a = static_cast<double>(prediction(q));
        const double b = image.grey(q);
        sp += a;
        si += b;
        spp += a * a;
        sii += b * b;
        n += 1.0;
      }
    }
  }
  if (n < 100.0) return;
  const double variance_p = spp / n - sp * sp / (n * n);
  const double variance_i = sii / n - si * si / (n * n);
  if (variance_p < 1.0 || variance_i < 1.0) return;
  const double gain = std::clamp(std::sqrt(variance_i / variance_p), 0.5, 2.0);
  const double offset = (si - gain * sp) / n;
  prediction.convertTo(prediction, CV_32F, gain, offset);
}

/// Takes out of `prediction` what it is too bright or too dark by over wide areas, as a vignette leaves it. `H`: from
/// the reference that was predicted from.
void matchBrightnessOverAreas(const InitializerImage& image, const cv::Mat1b& reference_mask, const Eigen::Matrix3d& H,
                              cv::Mat1f& prediction) {
  cv::Mat1b both;
  cv::bitwise_and(image.mask, warp(reference_mask, H, cv::BORDER_CONSTANT), both);
  cv::Mat1f excess, share;
  cv::subtract(image.grey, prediction, excess, cv::noArray(), CV_32F);
  excess.setTo(0.0F, ~both);
  both.convertTo(share, CV_32F, 1.0 / 255.0);
  const int side = image.grey.cols / kAreasAcross;
  cv::blur(excess, excess, {side, side}, {-1, -1}, cv::BORDER_CONSTANT);
  cv::blur(share, share, {side, side}, {-1, -1}, cv::BORDER_CONSTANT);
  excess /= cv::max(share, kLeastShare);
  prediction += excess;
}

/// Fits the homography again to what was tracked; keeps the prediction where that is too little.
void refit(const std::vector<Eigen::Vector2d>& corners, FrameTracks& tracks) {
  std::vector<cv::Point2d> from, to;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!tracks.tracked[i]) continue;
    from.emplace_back(corners[i].x(), corners[i].y());
    to.emplace_back(tracks.pixel[i].x(), tracks.pixel[i].y());
  }
  if (static_cast<int>(from.size()) >= kMinHomographyTracks) {
    const cv::Mat H = cv::findHomography(from, to, cv::RANSAC, kTrackTolerance, cv::noArray(), 200);
    if (!H.empty()) cv::cv2eigen(H, tracks.H_frame_reference);
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!tracks.tracked[i]) tracks.pixel[i] = applyHomography(tracks.H_frame_reference, corners[i]);
  }
}

}  // namespace

ReferenceTracker::ReferenceTracker(InitializerImageConstPtr reference, int max_corners)
    : reference_(std::move(reference)) {
  for (const cv::Point2f& p : selectCorners(*reference_, max_corners)) corners_.emplace_back(p.x, p.y);
}

FrameTracks ReferenceTracker::identity() const {
  FrameTracks tracks;
  tracks.pixel = corners_;
  tracks.tracked.assign(corners_.size(), 1);
  tracks.count = static_cast<int>(corners_.size());
  return tracks;
}

FrameTracks ReferenceTracker::track(const InitializerImage& image, const FrameTracks& neighbour,
                                    const Eigen::Matrix3d& H_image_neighbour,
                                    const Eigen::Vector3d& exposure_rotation) const {
  FrameTracks tracks;
  tracks.H_frame_reference = H_image_neighbour * neighbour.H_frame_reference;
  tracks.tracked.assign(corners_.size(), 0);
  std::vector<std::size_t> index;
  std::vector<cv::Point2f> from, to;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Eigen::Vector2d p = applyHomography(tracks.H_frame_reference, corners_[i]);
    tracks.pixel.push_back(applyHomography(H_image_neighbour, neighbour.pixel[i]));
    const Eigen::Vector2d& q = tracks.pixel.back();
    if (!image.camera.contains(p, kMargin) || !image.camera.contains(q, kMargin)) continue;
    index.push_back(i);
    from.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
    to.emplace_back(static_cast<float>(q.x()), static_cast<float>(q.y()));
  }
  if (index.empty()) return tracks;
  cv::Mat1f prediction = predictImage(*reference_, tracks.H_frame_reference, exposure_rotation);
  matchBrightness(image, from, prediction);
  matchBrightnessOverAreas(image, reference_->mask, tracks.H_frame_reference, prediction);
  std::vector<cv::Mat> pyramid;
  const cv::Size window(kWindow, kWindow);
  const cv::TermCriteria stop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 15, 0.01);
  cv::Mat1b rounded;
  prediction.convertTo(rounded, CV_8U);
  cv::buildOpticalFlowPyramid(rounded, pyramid, window, kLevels);
  std::vector<cv::Point2f> back = from;
  std::vector<uchar> found, found_back;
  cv::calcOpticalFlowPyrLK(pyramid, image.pyramid, from, to, found, cv::noArray(), window, kLevels, stop,
                           cv::OPTFLOW_USE_INITIAL_FLOW, 1e-4);
  cv::calcOpticalFlowPyrLK(image.pyramid, pyramid, to, back, found_back, cv::noArray(), window, 0, stop,
                           cv::OPTFLOW_USE_INITIAL_FLOW, 1e-4);
  for (std::size_t k = 0; k < index.size(); ++k) {
    if (!found[k] || !found_back[k] || cv::norm(back[k] - from[k]) > kMaxTrackRoundTrip) continue;
    const Eigen::Vector2d q(to[k].x, to[k].y);
    if (!image.camera.contains(q, kMargin) || !image.mask(cvRound(to[k].y), cvRound(to[k].x))) continue;
    tracks.pixel[index[k]] = q;
    tracks.tracked[index[k]] = 1;
    ++tracks.count;
  }
  refit(corners_, tracks);
  return tracks;
}

}  // namespace mba_vo
