#include "mba_vo/trajectory/odometry_velocity.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "trajectory/covariance_fixture.h"

namespace mba_vo::test::odometry_velocity_test {
namespace {

Vector6 trueVelocity(double t) {
  return vector6(0.3 * std::sin(5.0 * t), 0.2 * std::cos(4.0 * t), 0.25 * std::sin(6.0 * t + 1.0), std::sin(7.0 * t),
                 std::cos(5.0 * t), 0.9 * std::sin(6.0 * t + 2.0));
}

/// Camera to odom, by small steps of the true motion.
class TrueMotion {
 public:
  const SE3& at(int image) {
    constexpr int kSteps = 100;
    for (; image_ < image; ++image_) {
      for (int k = 0; k < kSteps; ++k) {
        const double t = kInterval * (image_ + (k + 0.5) / kSteps);
        T_odom_camera_ = T_odom_camera_ * SE3::exp(kInterval / kSteps * trueVelocity(t));
      }
    }
    return T_odom_camera_;
  }

 private:
  int image_ = 0;
  SE3 T_odom_camera_;
};

TEST(OdometryVelocity, BeginsWithWhatTheBlurTells) {
  OdometryVelocity velocity;
  EXPECT_EQ(velocity.last().motion.velocity, Vector6::Zero());
  const TrackedFrame tracked = trackedAt(0, 1, 1);
  velocity.add(tracked, SE3());
  EXPECT_EQ(velocity.last().motion.velocity, tracked.trajectory.velocity);
  const Matrix6 expected = 1e-8 / (0.02 * 0.02) * Matrix6::Identity();
  EXPECT_LT(relativeDifference(velocity.last().covariance, expected), 1e-12);

  TrackedFrame other_map = trackedAt(1, 2, 1);
  other_map.exposure_estimate = {2.0, 0.1, true};
  velocity.add(other_map, SE3::exp(vector6(3.0, 0.0, 0.0, 0.0, 0.0, 0.0)));
  EXPECT_EQ(velocity.last().motion.velocity, tracked.trajectory.velocity) << "poses of two maps tell no way";
  const Vector6 unknown = 0.1 * tracked.trajectory.velocity;
  EXPECT_LT(relativeDifference(velocity.last().covariance, expected + unknown * unknown.transpose()), 1e-12);

  OdometryVelocity sharp;
  TrackedFrame without = trackedAt(0, 1, 1);
  without.trajectory.exposure = 0.0;
  sharp.add(without, SE3());
  EXPECT_GT(sharp.last().covariance(0, 0), 1e3) << "nothing tells";
}

TEST(OdometryVelocity, OfTheAlignmentItIsThatOfTheMotionWithinTheExposure) {
  const Matrix6 expected = 1e-8 / (0.02 * 0.02) * Matrix6::Identity();
  OdometryVelocity velocity;
  const auto byAlignment = [&](const TrackedFrame& tracked) {
    velocity.add(tracked, SE3());
    return velocity.last().covariance_by_alignment;
  };
  EXPECT_LT(relativeDifference(byAlignment(trackedAt(0, 1, 1)), expected), 1e-12);
  EXPECT_LT(relativeDifference(byAlignment(trackedAt(1, 1, 1)), expected), 1e-12) << "whatever poses tell";
  TrackedFrame limited = trackedAt(2, 1, 1);
  limited.xi_prior_limited = true;  // then the prior is in it
  EXPECT_LT(relativeDifference(byAlignment(limited), expected), 1e-12);
  TrackedFrame estimated = trackedAt(3, 1, 1);
  estimated.exposure_estimate = {2.0, 0.1, true};
  const Vector6 unknown = 0.1 * estimated.trajectory.velocity;
  EXPECT_LT(relativeDifference(byAlignment(estimated), expected + unknown * unknown.transpose()), 1e-12);
  for (const double expected_error : {0.0, 0.3}) {
    TrackedFrame tracked = trackedAt(expected_error > 0.0 ? 5 : 4, 1, 1);
    tracked.expected_error = expected_error;
    const double factor = kNoiseShare + std::pow(expected_error / kModelError, 2);
    EXPECT_LT(relativeDifference(byAlignment(tracked), factor * expected), 1e-12) << expected_error << " px";
  }
}

/// Of sharp images the alignment's velocity is the mean between the two images before.
TEST(OdometryVelocity, WithoutExposureThatOfTheAlignmentIsAsOldAsItIs) {
  OdometryVelocity velocity;
  TrueMotion truth;
  double sum = 0.0;
  constexpr int kSkipped = 50;
  constexpr int kCount = 400;
  for (int i = 0; i < kSkipped + kCount; ++i) {
    TrackedFrame tracked = trackedAt(i, 1, 1);
    std::const_pointer_cast<Frame>(tracked.frame)->exposure = 0.0;
    tracked.trajectory.exposure = 0.0;
    tracked.covariance *= 1e-6;
    const double t = kInterval * i;
    tracked.trajectory.velocity = trueVelocity(t - 1.5 * kInterval);
    velocity.add(tracked, truth.at(i));
    const Matrix6& P = velocity.last().covariance_by_alignment;
    if (i == 0) {
      EXPECT_GT(P(0, 0), 1e3) << "nothing is known at first";
    }
    const Vector6 error = trueVelocity(t) - tracked.trajectory.velocity;
    if (i >= kSkipped) sum += error.dot(P.llt().solve(error)) / 6.0 / kCount;
  }
  EXPECT_GT(sum, 0.5);
  EXPECT_LT(sum, 2.0);
}

TEST(OdometryVelocity, TellsWaysByThePosesAndNotByTheBlur) {
  OdometryVelocity velocity;
  TrueMotion truth;
  double by_blur = 0.0, published = 0.0;
  for (int i = 0; i < 200; ++i) {
    TrackedFrame tracked = trackedAt(i, 1, 1);
    tracked.trajectory.velocity = trueVelocity(kInterval * i);
    tracked.trajectory.velocity.head<3>().array() += 0.1;  // a reference that was blurred otherwise
    velocity.add(tracked, truth.at(i));
    by_blur += (tracked.trajectory.velocity - trueVelocity(kInterval * i)).head<3>().squaredNorm();
    published += (velocity.last().motion.velocity - trueVelocity(kInterval * i)).head<3>().squaredNorm();
  }
  EXPECT_LT(std::sqrt(published / by_blur), 0.25);
}

/// With and without a blur that tells the turn.
TEST(OdometryVelocity, KnowsHowWellItKnows) {
  for (const bool told : {true, false}) {
    OdometryVelocity velocity;
    TrueMotion truth;
    std::mt19937 generator(5);
    std::normal_distribution<double> normal;
    const double noise = 2e-4, blur_noise = 0.02;  // [m, rad], [rad/s]
    double ways = 0.0, turns = 0.0;
    constexpr int kCount = 400;
    for (int i = 0; i < kCount + 4; ++i) {
      const auto draw = [&] { return Vector6(Vector6::NullaryExpr([&](auto) { return normal(generator); })); };
      TrackedFrame tracked = trackedAt(i, 1, 1);
      if (!told) std::const_pointer_cast<Frame>(tracked.frame)->exposure.reset();
      tracked.trajectory.velocity = trueVelocity(kInterval * i) + blur_noise * draw();
      tracked.covariance.topLeftCorner<6, 6>() = noise * noise * Matrix6::Identity();
      tracked.covariance.bottomRightCorner<6, 6>() = std::pow(0.02 * blur_noise, 2) * Matrix6::Identity();
      velocity.add(tracked, truth.at(i) * SE3::exp(noise * draw()));
      if (i < 4) continue;
      const Vector6 error = velocity.last().motion.velocity - trueVelocity(kInterval * i);
      const Matrix6& P = velocity.last().covariance;
      ways += error.head<3>().dot(P.topLeftCorner<3, 3>().llt().solve(error.head<3>())) / 3.0 / kCount;
      turns += error.tail<3>().dot(P.bottomRightCorner<3, 3>().llt().solve(error.tail<3>())) / 3.0 / kCount;
    }
    EXPECT_GT(ways, 0.2) << told;
    EXPECT_LT(ways, 2.0) << told;
    EXPECT_GT(turns, 0.04) << told << ": hands change a turn more suddenly than this";
    EXPECT_LT(turns, 2.0) << told;
  }
}

TEST(OdometryVelocity, RowsAreBelievedAboutTurns) {
  OdometryVelocity velocity;
  for (int i = 0; i < 3; ++i) {
    TrackedFrame tracked = trackedAt(i, 1, 1);
    auto frame = std::make_shared<Frame>(*tracked.frame);
    cv::Mat1f image(60, 80, 100.0F);
    PinholeCamera camera{80, 60, 60.0, 60.0, 39.5, 29.5};
    camera.row_time = 1e-4;
    frame->pyramid = ImagePyramid(image, camera, 1);
    tracked.frame = frame;
    tracked.trajectory.acceleration = vector6(0.0, 0.0, 0.0, 4.0, 5.0, 6.0);
    velocity.add(tracked, SE3());
  }
  const BodyMotion& motion = velocity.last().motion;
  EXPECT_EQ(motion.velocity, vector6(0.0, 0.0, 0.0, 0.0, 1.0, 0.0)) << "of the way, the poses say that it stands";
  EXPECT_EQ(motion.acceleration, vector6(0.0, 0.0, 0.0, 4.0, 5.0, 6.0));
  const Matrix6& P = velocity.last().covariance;
  EXPECT_NEAR(P(4, 4), 1e-8 / (0.02 * 0.02), 1e-12);
  EXPECT_EQ(P(0, 4), 0.0);
}

TEST(OdometryVelocity, AFrameThatIsNotLaterChangesNothing) {
  OdometryVelocity velocity;
  for (int i = 0; i < 4; ++i) velocity.add(trackedAt(i, 1, 1), SE3::exp(kInterval * i * vector6(1, 0, 0, 0, 0, 0)));
  const Vector6 before = velocity.last().motion.velocity;
  velocity.add(trackedAt(2, 1, 1), SE3());
  velocity.add(trackedAt(3, 1, 1), SE3());
  EXPECT_EQ(velocity.last().motion.velocity, before);
}

}  // namespace
}  // namespace mba_vo::test::odometry_velocity_test
