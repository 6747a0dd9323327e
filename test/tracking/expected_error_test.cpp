#include "mba_vo/tracking/expected_error.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::expected_error_test {
namespace {

const PinholeCamera kCamera{376, 240, 215.0, 220.0, 187.0, 119.0};

Reference makeReference(int points) {
  test::Random random(3);
  Reference reference;
  reference.pyramid = std::make_shared<const ImagePyramid>(cv::Mat1f(240, 376, 100.0F), kCamera, 1);
  for (int i = 0; i < points; ++i) {
    const Eigen::Vector2d pixel(random.uniform(20, 355), random.uniform(20, 219));
    reference.points.push_back({pixel.cast<float>(), static_cast<float>(random.uniform(0.25, 1.0)), 0.0F});
  }
  return reference;
}

Eigen::Vector2d seenFrom(const SE3& T_reference_frame, const ReferencePoint& point) {
  const Eigen::Vector3d P = kCamera.unproject(point.pixel.cast<double>()) / static_cast<double>(point.inverse_depth);
  return kCamera.project(T_reference_frame.inverse() * P);
}

TEST(ExpectedPixelError, IsTheSpreadOfRandomPoses) {
  test::Random random(5);
  const Reference reference = makeReference(1);
  Vector6 motion;
  motion << 0.05, -0.03, 0.08, 0.02, -0.04, 0.1;
  const SE3 T = SE3::exp(motion);
  Vector6 sigma;
  sigma << 0.004, 0.002, 0.006, 0.001, 0.003, 0.002;
  Matrix6 mix = Matrix6::Identity();
  for (int i = 0; i < 36; ++i) mix(i / 6, i % 6) += random.uniform(-0.5, 0.5);
  const Matrix6 factor = sigma.asDiagonal() * mix;  // increments factor * w, w white
  double sum = 0.0;
  constexpr int kPoses = 20000;
  for (int i = 0; i < kPoses; ++i) {
    Vector6 white;
    for (int k = 0; k < 6; ++k) white(k) = std::sqrt(3.0) * random.uniform(-1.0, 1.0);
    const SE3 moved = T * SE3::exp(factor * white);
    sum += (seenFrom(moved, reference.points.front()) - seenFrom(T, reference.points.front())).squaredNorm();
  }
  EXPECT_NEAR(expectedPixelError(reference, T, factor * factor.transpose()), std::sqrt(sum / kPoses),
              0.02 * std::sqrt(sum / kPoses));
}

TEST(ExpectedPixelError, IsThatOfThePointsThatFareWorst) {
  Reference reference = makeReference(400);
  Matrix6 covariance = Matrix6::Zero();
  covariance(0, 0) = 1e-4;  // sideways by 1 cm: near points move most
  const double usual = expectedPixelError(reference, SE3(), covariance);
  EXPECT_LT(usual, kCamera.fx * 0.01);
  EXPECT_GT(usual, 0.9 * kCamera.fx * 0.01);  // nearest at 1 m
  for (std::size_t i = 0; i < 10; ++i) reference.points[i].inverse_depth = 5.0F;
  EXPECT_LT(expectedPixelError(reference, SE3(), covariance), kCamera.fx * 0.01);  // a few do not count
  for (std::size_t i = 0; i < 40; ++i) reference.points[i].inverse_depth = 5.0F;
  EXPECT_NEAR(expectedPixelError(reference, SE3(), covariance), 5.0 * kCamera.fx * 0.01, 1e-3);
}

TEST(ExpectedPixelError, CountsWhatTheFrameSees) {
  const Reference reference = makeReference(100);
  const SE3 turned_round = SE3::exp((Vector6() << 0, 0, 0, 0, 3.0, 0).finished());
  EXPECT_EQ(expectedPixelError(reference, turned_round, Matrix6::Identity()), 0.0);
}

}  // namespace
}  // namespace mba_vo::expected_error_test
