#include "mba_vo/trajectory/odometry_covariance.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "trajectory/covariance_fixture.h"

namespace mba_vo::test::odometry_covariance_test {
namespace {

TEST(OdometryCovariance, GrowsWithEachKeyframeAndNotBetween) {
  FollowedOdometry covariance;
  const Matrix6 first = covariance.update(trackedAt(0, 1, 1), SE3(), SE3()).odom;
  EXPECT_LT(relativeDifference(first, 2.0 * alignment()), 1e-12) << "of its keyframe and its own";
  const SE3 T_first_second = SE3::exp(vector6(0.0, 0.0, 0.0, 0.2, 0.7, 0.1));
  const Matrix6 seen = seenThrough(T_first_second.inverse(), alignment());
  const MotionCovariance second = covariance.update(trackedAt(1, 1, 1), T_first_second, SE3());
  EXPECT_LT(relativeDifference(second.odom, seen + alignment()), 1e-12);
  const MotionCovariance same = covariance.update(trackedAt(2, 1, 1), T_first_second, SE3());
  EXPECT_LT(relativeDifference(same.odom, second.odom), 1e-12);
  const MotionCovariance next = covariance.update(trackedAt(3, 1, 2), T_first_second, SE3());
  EXPECT_LT(relativeDifference(next.odom, seen + 2.0 * alignment()), 1e-12);
  const MotionCovariance third = covariance.update(trackedAt(4, 1, 3), T_first_second, SE3());
  EXPECT_LT(relativeDifference(third.odom, seen + (2.0 + kKeyframeShare) * alignment()), 1e-12);
  EXPECT_LT(relativeDifference(next.map, next.odom), 1e-12) << "map and odom are one until the map is corrected";
}

TEST(OdometryCovariance, AnAlignmentThatIsHardlyDeterminedErrsByMoreThanItsNoise) {
  for (const double expected_error : {0.0, 0.1, 0.3}) {
    FollowedOdometry covariance;
    covariance.update(trackedAt(0, 1, 1), SE3(), SE3());
    TrackedFrame tracked = trackedAt(1, 1, 1);
    tracked.expected_error = expected_error;
    const double factor = kNoiseShare + std::pow(expected_error / kModelError, 2);
    const MotionCovariance result = covariance.update(tracked, SE3(), SE3());
    EXPECT_LT(relativeDifference(result.odom, (1.0 + factor) * alignment()), 1e-12)
        << expected_error << " px, beside the first pose of the map";
  }
}

/// Of the first depths of a map; it shows where the camera has moved since, in the direction of the way.
TEST(OdometryCovariance, TheFirstScaleOfAMapIsUncertain) {
  FollowedOdometry covariance;
  const SE3 T_odom_first(Eigen::Quaterniond::Identity(), Eigen::Vector3d(4.0, 0.0, 0.0));
  const Matrix6 first = covariance.update(trackedAt(0, 1, 1), T_odom_first, SE3()).odom;
  EXPECT_LT(relativeDifference(first, 2.0 * alignment()), 1e-12) << "however far from where odom began";
  const SE3 turned = SE3::exp(vector6(0.0, 0.0, 0.0, 0.0, 1.0, 0.0));
  const SE3 T_first_second(turned.rotation(), Eigen::Vector3d(0.0, 3.0, 1.0));
  const MotionCovariance second = covariance.update(trackedAt(1, 1, 1), T_odom_first * T_first_second, SE3());
  const Eigen::Vector3d way = T_first_second.rotation().conjugate() * T_first_second.translation();
  Matrix6 expected = seenThrough(T_first_second.inverse(), alignment()) + alignment();
  expected.topLeftCorner<3, 3>() += kFirstScale * kFirstScale * way * way.transpose();
  EXPECT_LT(relativeDifference(second.odom, expected), 1e-12);
  EXPECT_LT(relativeDifference(covariance.update(trackedAt(2, 2, 9), SE3(), SE3()).map, 2.0 * alignment()), 1e-12)
      << "each map has its own";
}

/// Chains of poses with errors as the covariance supposes them, composed as motions: what they scatter by is what it
/// says.
TEST(OdometryCovariance, IsTheScatterOfChainsOfKeyframes) {
  constexpr int kKeyframes = 6;
  constexpr int kSamples = 4000;
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  const Matrix6 root = alignment().llt().matrixL();
  const auto draw = [&](double share) {
    Vector6 noise;
    for (double& n : noise) n = normal(generator);
    return Vector6(std::sqrt(share) * root * noise);
  };
  std::vector<SE3> poses;  // one image for each keyframe, far apart
  for (int i = 0; i < kKeyframes; ++i) {
    poses.push_back(SE3::exp(vector6(0.8 * i, -0.3 * i, 0.2, 0.3 * i, 0.4 * i, -0.1)));
  }
  FollowedOdometry covariance;
  MotionCovariance expected;
  for (int i = 0; i < kKeyframes; ++i) {
    expected = covariance.update(trackedAt(i, 1, static_cast<KeyframeId>(i)), poses[static_cast<std::size_t>(i)], {});
  }
  const SE3& last = poses.back();
  Matrix6 scatter = Matrix6::Zero();
  for (int sample = 0; sample < kSamples; ++sample) {
    SE3 T_estimated_true;  // of the keyframe in use, in odom
    Eigen::Vector3d stretch = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < kKeyframes; ++i) {
      const SE3& frame = poses[i > 0 ? i - 1 : 0];  // the last one when the keyframe comes into use
      const double share = i > 0 && i + 1 < kKeyframes ? kKeyframeShare : 1.0;
      T_estimated_true = T_estimated_true * frame * SE3::exp(draw(share)) * frame.inverse();
      stretch += (i > 0 ? kScaleDrift : kFirstScale) * normal(generator) * (last.translation() - frame.translation());
    }
    const SE3 stretched(last.rotation(), last.translation() + stretch);
    const Vector6 error = (last.inverse() * T_estimated_true * stretched * SE3::exp(draw(1.0))).log();
    scatter += error * error.transpose() / kSamples;
  }
  EXPECT_LT(relativeDifference(expected.odom, scatter), 0.1);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(expected.odom(i, i) / scatter(i, i), 1.0, 0.1) << i;
}

TEST(OdometryCovariance, CorrectionsOfTheMapAreMissingInOdom) {
  FollowedOdometry covariance;
  const SE3 T_odom_camera = SE3::exp(vector6(0.0, 1.0, 0.0, 0.3, 0.0, 0.0));
  const Matrix6 before = covariance.update(trackedAt(0, 1, 1), T_odom_camera, SE3()).map;
  const Vector6 correction = vector6(0.004, -0.003, 0.002, 0.001, 0.005, 0.0);  // of the camera in the map
  const SE3 T_map_odom = T_odom_camera * SE3::exp(correction) * T_odom_camera.inverse();
  for (int i = 1; i < 3; ++i) {
    const MotionCovariance corrected = covariance.update(trackedAt(i, 1, 1), T_odom_camera, T_map_odom);
    const Matrix6 map = before + kCorrectionShare * correction * correction.transpose();
    EXPECT_LT(relativeDifference(corrected.map, map), 1e-9);
    EXPECT_LT(relativeDifference(corrected.odom, map + correction * correction.transpose()), 1e-9);
  }
}

TEST(OdometryCovariance, StaysSymmetricAndPositiveDefinite) {
  FollowedOdometry covariance;
  SE3 T_odom_camera;
  SE3 T_map_odom;
  double last_trace = 0.0;
  for (int i = 0; i < 3000; ++i) {
    T_odom_camera = T_odom_camera * SE3::exp(vector6(0.1, 0.02 * std::sin(i), 0.0, 0.1, std::sin(0.1 * i), 0.05));
    T_map_odom = T_map_odom * SE3::exp(1e-3 * vector6(std::cos(i), 0.0, 1.0, 0.0, std::sin(i), 0.0));
    const MotionCovariance result =
        covariance.update(trackedAt(i, 1, static_cast<KeyframeId>(i)), T_odom_camera, T_map_odom);
    for (const Matrix6& P : {result.map, result.odom}) {
      ASSERT_LT(relativeDifference(P.transpose(), P), 1e-9) << i;
      ASSERT_EQ(Matrix6(0.5 * (P + P.transpose())).llt().info(), Eigen::Success) << i;
    }
    const double trace = result.map.bottomRightCorner<3, 3>().trace();
    ASSERT_GT(trace, last_trace) << i;
    last_trace = trace;
  }
}

/// Odometry goes on from where it was when the camera is found elsewhere in the map: what it missed is an error of
/// odom, and none of the map.
TEST(OdometryCovariance, FoundAgainCountsTheUnknownMotion) {
  FollowedOdometry covariance;
  const SE3 T_map_odom = SE3::exp(vector6(0.2, 0.0, 0.0, 0.0, 0.1, 0.0));
  const SE3 T_odom_camera = SE3::exp(vector6(0.0, 1.0, 0.0, 0.3, 0.0, 0.0));
  const Matrix6 before = covariance.update(trackedAt(0, 1, 1), T_odom_camera, T_map_odom).odom;
  EXPECT_EQ(covariance.update(lostAt(1), T_odom_camera, T_map_odom).odom, Matrix6::Zero());
  const Vector6 missed = vector6(0.4, -0.3, 0.2, 0.1, 0.5, 0.0);  // T_before_found
  const SE3 T_map_odom_found = T_map_odom * T_odom_camera * SE3::exp(missed) * T_odom_camera.inverse();
  const MotionCovariance found = covariance.update(trackedAt(20, 1, 1), T_odom_camera, T_map_odom_found);
  EXPECT_LT(relativeDifference(found.map, before), 1e-12);
  EXPECT_LT(relativeDifference(found.odom, before + missed * missed.transpose()), 1e-9);
}

TEST(OdometryCovariance, ANewMapKeepsWhatWasBeforeAndAddsTheUnknownMotion) {
  FollowedOdometry covariance;
  const Matrix6 before = covariance.update(trackedAt(0, 1, 1), SE3(), SE3()).odom;
  const SE3 T_other_map = SE3::exp(vector6(5.0, 1.0, 0.0, 0.0, 2.0, 0.0));
  constexpr int kImages = 25;
  const double seconds = kInterval * kImages;
  const MotionCovariance next = covariance.update(trackedAt(kImages, 2, 1), SE3(), T_other_map);
  EXPECT_LT(relativeDifference(next.map, 2.0 * alignment()), 1e-12);
  Matrix6 expected = before + 2.0 * alignment();
  expected.diagonal().head<3>().array() += 0.25 * seconds * seconds / 3.0;  // speeds 0.5 m/s and 1 rad/s
  expected.diagonal().tail<3>().array() += seconds * seconds / 3.0;
  EXPECT_LT(relativeDifference(next.odom, expected), 1e-12) << "where the maps lie in odom is no motion";
}

TEST(OdometryCovariance, WithoutMapTheTurnIsKnownOnceItIsMeasured) {
  FollowedOdometry covariance;
  const MotionCovariance start = covariance.update(turnedAt(0), SE3(), SE3());
  EXPECT_EQ(start.odom(0, 0), 1e6);
  EXPECT_LT((start.odom - turnedAt(0).covariance.topLeftCorner<6, 6>()).norm(), 1e-12);
  const Matrix6 in_map = covariance.update(trackedAt(1, 1, 1), SE3(), SE3()).odom;
  EXPECT_LT(relativeDifference(in_map, 2.0 * alignment()), 1e-12) << "the first map begins where odometry does";
  const auto turn = [&](int image) { return covariance.update(turnedAt(image), SE3(), SE3()).odom(4, 4); };
  const double expected = in_map(4, 4) + alignment()(4, 4) + kInterval * kInterval / 3.0;  // at 1 rad/s
  EXPECT_NEAR(turn(2), expected, 1e-12);
  EXPECT_NEAR(turn(30), expected, 1e-12);
  const MotionCovariance next = covariance.update(trackedAt(31, 2, 1), SE3(), SE3());
  EXPECT_NEAR(next.odom(4, 4), expected + alignment()(4, 4), 1e-12);
  EXPECT_GT(next.odom(0, 0), 0.25 * std::pow(30 * kInterval, 2) / 3.0) << "nothing measured the position";
}

TEST(OdometryCovariance, ResetForgetsEverything) {
  FollowedOdometry covariance;
  const Matrix6 first = covariance.update(trackedAt(0, 1, 1), SE3(), SE3()).odom;
  covariance.update(trackedAt(1, 1, 2), SE3(), SE3());
  covariance.reset();
  EXPECT_EQ(covariance.update(trackedAt(500, 4, 9), SE3(), SE3()).odom, first);
}

/// While a camera is lost its turn is measured, and its place predicted; when it is found, the map is known as before.
TEST(OdometryCovariance, LostInAMapOnlyThePlaceIsInDoubt) {
  FollowedOdometry covariance;
  MotionCovariance last;
  for (int i = 0; i < 3; ++i) last = covariance.update(trackedAt(i, 1, 1), SE3(), SE3());
  FollowedOdometry never_lost = covariance;
  TrackedFrame turned = turnedAt(3);
  turned.status = TrackingStatus::kLost;
  turned.reference.map_id = 1;
  const MotionCovariance at_once = covariance.update(turned, SE3(), SE3());
  const Matrix6 grown = at_once.odom - last.odom;
  const Eigen::Matrix3d turn = alignment().block(3, 3, 3, 3);
  EXPECT_LT(Eigen::Matrix3d(grown.block(3, 3, 3, 3) - turn).norm(), 1e-12);
  const double velocity = 1e-8 / (0.02 * 0.02);  // variance, of each coordinate [m^2/s^2]
  EXPECT_NEAR(grown(0, 0), velocity * kInterval * kInterval, 1e-12) << "it did not change, but was not known exactly";
  turned.frame = trackedAt(3 + 50, 1, 1).frame;
  const Matrix6 later = covariance.update(turned, SE3(), SE3()).odom - last.odom;
  const double unmeasured = kInterval * 51 - 0.15;  // [s]
  EXPECT_NEAR(later(0, 0), velocity * 0.15 * 0.15 + 0.25 / 3.0 * unmeasured * unmeasured, 1e-9) << "at 0.5 m/s";
  const MotionCovariance found = covariance.update(trackedAt(54, 1, 1), SE3(), SE3());
  EXPECT_LT(relativeDifference(found.map, never_lost.update(trackedAt(54, 1, 1), SE3(), SE3()).map), 1e-12);
}

}  // namespace
}  // namespace mba_vo::test::odometry_covariance_test
