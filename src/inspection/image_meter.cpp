#include "mba_vo/inspection/image_meter.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "mba_vo/image/image_noise.h"
#include "mba_vo/image/saturation.h"

namespace mba_vo {
namespace {

constexpr double kWhite = 255.0;

struct GradientPower {
  double x, y;  // mean squares of central differences [grey levels / px]
};

GradientPower gradientPower(const cv::Mat1f& grey) {
  if (grey.cols < 3 || grey.rows < 3) return {0.0, 0.0};
  const cv::Rect inside(1, 1, grey.cols - 2, grey.rows - 2);
  cv::Mat1f dx;
  cv::Mat1f dy;
  cv::subtract(grey(inside + cv::Point(1, 0)), grey(inside - cv::Point(1, 0)), dx);
  cv::subtract(grey(inside + cv::Point(0, 1)), grey(inside - cv::Point(0, 1)), dy);
  const auto pixels = static_cast<double>(inside.area());
  constexpr double kStep = 2.0;  // [px] between the two
  return {dx.dot(dx) / (kStep * kStep * pixels), dy.dot(dy) / (kStep * kStep * pixels)};
}

double detailOf(const cv::Mat1f& grey) {
  cv::Mat1f half;
  cv::Mat1f quarter;
  cv::pyrDown(grey, half);
  cv::pyrDown(half, quarter);
  const GradientPower fine = gradientPower(grey);
  const GradientPower coarse = gradientPower(quarter);
  const double noise = std::pow(static_cast<double>(estimateNoise(grey)), 2) / 2.0;  // of a central difference
  const auto ratio = [&](double f, double c) { return c > 0.0 ? std::sqrt(std::max(0.0, f - noise) / c) : 0.0; };
  constexpr double kScale = 4.0;  // px of the image per px of the quarter
  return std::max(0.0, kScale * std::max(ratio(fine.x, coarse.x), ratio(fine.y, coarse.y)) - 1.0);
}

/// Points of the last image, and where they are now.
struct Matches {
  std::vector<cv::Point2f> before, now;
};

Matches followCorners(const cv::Mat1b& before, const cv::Mat1b& now) {
  constexpr int kMostCorners = 200;
  constexpr double kQuality = 0.01;
  constexpr double kDistance = 8.0;  // [px]
  const cv::Size window(15, 15);
  constexpr int kLevels = 4;
  Matches matches;
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(before, corners, kMostCorners, kQuality, kDistance);
  if (corners.empty()) return matches;
  std::vector<cv::Point2f> there;
  std::vector<cv::Point2f> back;
  std::vector<std::uint8_t> found;
  std::vector<std::uint8_t> found_back;
  cv::calcOpticalFlowPyrLK(before, now, corners, there, found, cv::noArray(), window, kLevels);
  cv::calcOpticalFlowPyrLK(now, before, there, back, found_back, cv::noArray(), window, kLevels);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    constexpr double kAgreement = 0.5;  // [px]
    if (found[i] == 0 || found_back[i] == 0 || cv::norm(back[i] - corners[i]) > kAgreement) continue;
    matches.before.push_back(corners[i]);
    matches.now.push_back(there[i]);
  }
  return matches;
}

/// Logarithm of how much brighter the points are now, whatever moved.
std::optional<double> brightening(const cv::Mat1b& before, const cv::Mat1b& now, const Matches& matches) {
  constexpr double kDark = 20.0;     // [grey levels]; black is not quite 0 in all cameras
  constexpr double kBright = 235.0;  // the same; around white the mean is too dark
  constexpr std::size_t kFewest = 20;
  const cv::Size around(5, 5);
  cv::Mat1f mean_before;
  cv::Mat1f mean_now;
  cv::boxFilter(before, mean_before, CV_32F, around);
  cv::boxFilter(now, mean_now, CV_32F, around);
  std::vector<double> ratios;
  const cv::Rect image({0, 0}, now.size());
  for (std::size_t i = 0; i < matches.now.size(); ++i) {
    const cv::Point p(cvRound(matches.before[i].x), cvRound(matches.before[i].y));
    const cv::Point q(cvRound(matches.now[i].x), cvRound(matches.now[i].y));
    if (!image.contains(p) || !image.contains(q)) continue;
    const double a = static_cast<double>(mean_before(p));
    const double b = static_cast<double>(mean_now(q));
    if (std::min(a, b) > kDark && std::max(a, b) < kBright) ratios.push_back(std::log(b / a));
  }
  if (ratios.size() < kFewest) return std::nullopt;
  return quantile(std::move(ratios), 0.5);
}

/// Motion as an affine function of the place, least squares without what fits badly.
/// Columns: x, y; rows: constant, per column, per row of the image.
Eigen::Matrix<double, 3, 2> fitAffine(const Matches& matches, cv::Point2d centre) {
  const auto n = static_cast<Eigen::Index>(matches.now.size());
  Eigen::MatrixX3d place(n, 3);
  Eigen::MatrixX2d flow(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const cv::Point2f& p = matches.before[static_cast<std::size_t>(i)];
    const cv::Point2f& q = matches.now[static_cast<std::size_t>(i)];
    place.row(i) << 1.0, p.x - centre.x, p.y - centre.y;
    flow.row(i) << q.x - p.x, q.y - p.y;
  }
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(n);
  Eigen::Matrix<double, 3, 2> fit;
  for (int round = 0; round < 5; ++round) {
    const Eigen::Matrix<double, 3, 3> H = place.transpose() * weight.asDiagonal() * place;
    fit = H.ldlt().solve(place.transpose() * weight.asDiagonal() * flow);
    const Eigen::VectorXd error = (flow - place * fit).rowwise().norm();
    weight = error.unaryExpr([](double e) { return 1.0 / (1.0 + e * e); });  // Cauchy, 1 px
  }
  return fit;
}

}  // namespace

cv::Mat1f greyImage(const cv::Mat& image, double white_level) {
  cv::Mat grey = image;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  if (image.channels() == 4) cv::cvtColor(image, grey, cv::COLOR_BGRA2GRAY);
  cv::Mat1f result;
  grey.convertTo(result, CV_32F, kWhite / white_level);
  return result;
}

PixelFacts measurePixels(const cv::Mat& image, const cv::Mat1f& grey, double white_level) {
  PixelFacts facts;
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(grey, mean, deviation);
  facts.mean = mean[0] / kWhite;
  facts.contrast = deviation[0] / kWhite;
  facts.saturated =
      static_cast<double>(cv::countNonZero(saturatedPixels(image, white_level))) / static_cast<double>(grey.total());
  facts.detail = detailOf(grey);
  return facts;
}

std::optional<MotionFacts> MotionMeter::add(const cv::Mat1f& grey) {
  constexpr std::size_t kFewest = 20;
  constexpr int kLargest = 500;  // [px] wide; what is wider is halved, for speed
  int scale = 1;
  cv::Mat1f small = grey;
  while (small.cols > kLargest) {
    cv::Mat1f half;
    cv::pyrDown(small, half);
    small = half;
    scale *= 2;
  }
  cv::Mat1b now;
  small.convertTo(now, CV_8U);
  const cv::Mat1b before = last_;
  last_ = now;
  if (before.size() != now.size()) return std::nullopt;
  const Matches matches = followCorners(before, now);
  if (matches.now.size() < kFewest) return std::nullopt;
  std::vector<double> lengths;
  for (std::size_t i = 0; i < matches.now.size(); ++i) {
    lengths.push_back(cv::norm(matches.now[i] - matches.before[i]));
  }
  const Eigen::Matrix<double, 3, 2> affine = fitAffine(matches, {0.5 * (now.cols - 1), 0.5 * (now.rows - 1)});
  MotionFacts facts;
  facts.length = scale * quantile(std::move(lengths), 0.5);
  facts.shear_x = affine(2, 0) + affine(1, 1);  // a turn about the optical axis has them equal and opposite
  facts.shear_y = affine(2, 1) - affine(1, 0);  // an approach has them equal
  facts.brighter = brightening(before, now, matches);
  facts.flow = {scale * affine(0, 0), scale * affine(0, 1)};
  return facts;
}

}  // namespace mba_vo
