#include "mba_vo/initialization/initializer_tracker.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "mba_vo/geometry/calibration_correction.h"

namespace mba_vo::initializer_tracker_test {
namespace {

const PinholeCamera kCamera{376, 240, 215.0, 215.0, 187.5, 119.5};
constexpr double kContrast = 25.0;  // [grey levels] of the texture, as heavy blur leaves it

/// A wall far away, seen by a camera that is turned by so much to the side and through a vignette.
InitializerImageConstPtr takeImage(double turn, const CalibrationCorrection::Vignette& vignette) {
  const double shift = kCamera.fx * turn;  // of the whole image, as for small angles [px]
  cv::Mat1f image(kCamera.height, kCamera.width);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double u = x + shift;
      const double wave = std::sin(0.23 * u) * std::cos(0.19 * y) + std::sin(0.11 * u + 0.17 * y + 1.0);
      const double light = std::exp(vignette.dot(vignetteJacobian(kCamera, {x, y})));
      image(y, x) = static_cast<float>(light * (130.0 + kContrast * wave));
    }
  }
  auto frame = std::make_shared<Frame>();
  frame->pyramid = ImagePyramid(image, kCamera, 4);
  return makeInitializerImage(frame);
}

/// Corners tracked, and their median error [px].
struct Tracked {
  int count;
  double error;
};

Tracked trackTurn(const CalibrationCorrection::Vignette& vignette) {
  constexpr double kTurn = 0.2;  // [rad] 43 px
  const ReferenceTracker tracker(takeImage(0.0, vignette), 300);
  const Eigen::Vector2d shift(-kCamera.fx * kTurn, 0.0);
  Eigen::Matrix3d H = Eigen::Matrix3d::Identity();
  H.topRightCorner<2, 1>() = shift + Eigen::Vector2d(1.0, -1.0);  // a pixel off
  const FrameTracks tracks = tracker.track(*takeImage(kTurn, vignette), tracker.identity(), H, Eigen::Vector3d::Zero());
  std::vector<double> errors;
  for (std::size_t i = 0; i < tracks.tracked.size(); ++i) {
    if (tracks.tracked[i]) errors.push_back((tracks.pixel[i] - tracker.corners()[i] - shift).norm());
  }
  if (errors.empty()) return {0, 1e9};
  std::sort(errors.begin(), errors.end());
  return {tracks.count, errors[errors.size() / 2]};
}

TEST(ReferenceTracker, AVignetteCostsLittle) {
  const Tracked even = trackTurn(CalibrationCorrection::Vignette::Zero());
  const Tracked dark_corners = trackTurn({-0.35, -0.061, -0.014});
  EXPECT_GT(even.count, 100);
  EXPECT_LT(even.error, 0.1);
  EXPECT_GT(dark_corners.count, 0.8 * even.count);
  EXPECT_LT(dark_corners.error, 0.13);
}

}  // namespace
}  // namespace mba_vo::initializer_tracker_test
