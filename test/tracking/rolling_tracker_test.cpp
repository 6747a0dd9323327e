#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "mba_vo/tracking/tracker.h"
#include "support/random.h"
#include "support/rendered_room.h"

namespace mba_vo::rolling_tracker_test {
namespace {

constexpr double kRowTime = 60e-6;  // [s]
constexpr unsigned kCases = 6;

const SimulatedFrame& referenceView() {
  static const SimulatedFrame view = test::roomView(40);
  return view;
}

ReferenceConstPtr reference() {
  static const ReferenceConstPtr reference = test::makeReference(referenceView(), test::toFloat(referenceView().sharp));
  return reference;
}

/// A frame of a camera with a rolling shutter, tracked without knowing anything of its motion.
struct Case {
  SE3 T_reference_mid;  // true
  Vector6 velocity;     // true
  TrackedFrame tracked;

  /// Normalised squared errors over their expectation.
  double poseNees() const {
    return nees((tracked.trajectory.T_reference_mid.inverse() * T_reference_mid).log(),
                tracked.covariance.topLeftCorner<6, 6>());
  }
  double velocityNees(double exposure) const {
    return nees(exposure * (velocity - tracked.trajectory.velocity), tracked.covariance.bottomRightCorner<6, 6>());
  }
  static double nees(const Vector6& error, const Matrix6& covariance) {
    return error.dot(covariance.ldlt().solve(error)) / 6.0;
  }
};

Case trackCase(unsigned seed, double row_time, double exposure) {
  SimulationConfig config = test::roomConfig();
  config.row_time = row_time;
  const Simulator simulator(config, sharedRoom());
  test::Random random(seed);
  Case c;
  c.T_reference_mid = random.pose(0.06, 0.05);
  c.velocity = random.tangent(0.5, 1.5);
  const SimulatedFrame rendered = simulator.renderExposure(
      test::constantVelocity(referenceView().T_world_mid * c.T_reference_mid, c.velocity), 0.0, exposure, seed);
  PinholeCamera camera = test::roomSimulator().camera();
  camera.row_time = row_time;
  auto frame = std::make_shared<Frame>();
  frame->exposure = exposure;
  frame->pyramid = ImagePyramid(test::toFloat(rendered.blurred), camera, 5);
  const ExposureTrajectory guess{c.T_reference_mid * random.pose(0.01, 0.005), Vector6::Zero(), exposure};
  c.tracked = Tracker({}).track(*reference(), frame, guess);
  EXPECT_EQ(c.tracked.status, TrackingStatus::kTracking) << c.tracked.reason;
  return c;
}

/// Exposure that the covariance's xi belongs to: a rolling shutter tells the velocity even if nothing is blurred.
double exposureOfXi(double exposure) { return std::max(exposure, 1e-4); }

Vector6 velocitySigma(const Case& c, double exposure) {
  return c.tracked.covariance.diagonal().tail<6>().cwiseSqrt() / exposureOfXi(exposure);
}

class RollingTracker : public testing::TestWithParam<double> {};

TEST_P(RollingTracker, FindsPoseAndVelocityHoweverShortTheExposure) {
  const double exposure = GetParam();
  double pose_nees = 0.0;
  double velocity_nees = 0.0;
  for (unsigned seed = 1; seed <= kCases; ++seed) {
    const Case c = trackCase(seed, kRowTime, exposure);
    const SE3& found = c.tracked.trajectory.T_reference_mid;
    EXPECT_LT(test::meanReprojectionError(referenceView().depth, c.T_reference_mid, found), 0.1) << "seed " << seed;
    const double readout = kRowTime * test::roomSimulator().camera().height;
    const auto motion =
        test::borderError(SE3::exp(readout * c.tracked.trajectory.velocity), SE3::exp(readout * c.velocity));
    EXPECT_GT(motion.true_length, 3.0);
    EXPECT_LT(motion.mean, 0.5) << "seed " << seed;
    pose_nees += c.poseNees() / kCases;
    velocity_nees += c.velocityNees(exposureOfXi(exposure)) / kCases;
  }
  // The covariance is that of the errors, within a factor of two and what six frames leave to chance.
  EXPECT_GT(pose_nees, 0.3);
  EXPECT_LT(pose_nees, 2.5);
  EXPECT_GT(velocity_nees, 0.3);
  EXPECT_LT(velocity_nees, 2.5);
}

INSTANTIATE_TEST_SUITE_P(Seconds, RollingTracker, testing::Values(0.0, 1e-3, 0.01));

TEST(RollingTracker, TheLongerTheReadoutTheBetterTheVelocityIsKnown) {
  const Vector6 slow = velocitySigma(trackCase(1, kRowTime, 0.0), 0.0);
  const Vector6 fast = velocitySigma(trackCase(1, 0.5 * kRowTime, 0.0), 0.0);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(fast(i) / slow(i), 2.0, 0.4) << "component " << i;
}

TEST(RollingTracker, AnExposureShorterThanTheReadoutHardlyChangesWhatIsKnownOfTheVelocity) {
  const Vector6 none = velocitySigma(trackCase(1, kRowTime, 0.0), 0.0);
  const Vector6 brief = velocitySigma(trackCase(1, kRowTime, 1e-3), 1e-3);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(brief(i) / none(i), 1.0, 0.25) << "component " << i;
}

/// What was before says that the turn goes on as it was; the rows say that it does not.
TEST(RollingTracker, FindsHowATurnChangesAgainstWhatIsExpected) {
  constexpr double kExposure = 2e-3;
  constexpr double kSlowRows = 110e-6;      // [s] 240 in 26 ms, as a webcam
  constexpr double kInterval = 1.0 / 30.0;  // [s]
  SimulationConfig config = test::roomConfig();
  config.row_time = kSlowRows;
  const Simulator simulator(config, sharedRoom());
  double missed = 0.0;  // share of the acceleration
  for (unsigned seed = 1; seed <= kCases; ++seed) {
    test::Random random(seed);
    BodyMotion motion{random.tangent(0.3, 1.0)};
    motion.acceleration.tail<3>() = 15.0 * random.tangent(1.0, 1.0).tail<3>().normalized();
    const SE3 T_reference_mid = random.pose(0.05, 0.04);
    const SE3 T_world_mid = referenceView().T_world_mid * T_reference_mid;
    const SimulatedFrame rendered = simulator.renderExposure(
        [&](double t) { return T_world_mid * SE3::exp(motion.until(t)); }, 0.0, kExposure, seed);
    auto frame = std::make_shared<Frame>(*test::makeFrame(test::toFloat(rendered.blurred), 0, kExposure));
    PinholeCamera camera = test::roomSimulator().camera();
    camera.row_time = kSlowRows;
    frame->pyramid = ImagePyramid(test::toFloat(rendered.blurred), camera, 5);
    MotionPrior prior;
    prior.dt = kInterval;
    prior.previous = {T_reference_mid * SE3::exp(-kInterval * motion.velocity), motion.velocity, kExposure};
    const TrackedFrame tracked = Tracker({}).track(*reference(), frame, TrackingGuess(prior, kExposure));
    EXPECT_EQ(tracked.status, TrackingStatus::kTracking) << tracked.reason;
    const Vector6 error = tracked.trajectory.acceleration - motion.acceleration;
    missed += error.tail<3>().norm() / motion.acceleration.norm() / kCases;
    EXPECT_LT(test::meanReprojectionError(referenceView().depth, T_reference_mid, tracked.trajectory.T_reference_mid),
              0.05)
        << "seed " << seed;
  }
  EXPECT_LT(missed, 0.6);  // four standard deviations of the prior, in a small image
}

/// A frame by rows as slow as a webcam's, and what is known of its motion before it is looked at.
struct UntoldExposure {
  static constexpr double kRows = 110e-6;          // [s] 240 in 26 ms
  static constexpr double kInterval = 1.0 / 30.0;  // [s]
  SE3 T_reference_mid;
  Vector6 velocity;
  Frame frame;

  UntoldExposure(unsigned seed, double exposure) {
    SimulationConfig config = test::roomConfig();
    config.row_time = kRows;
    test::Random random(seed);
    velocity = random.tangent(0.3, 1.0);
    T_reference_mid = random.pose(0.05, 0.04);
    const SimulatedFrame rendered =
        Simulator(config, sharedRoom())
            .renderExposure(test::constantVelocity(referenceView().T_world_mid * T_reference_mid, velocity), 0.0,
                            exposure, seed);
    PinholeCamera camera = test::roomSimulator().camera();
    camera.row_time = kRows;
    frame.pyramid = ImagePyramid(test::toFloat(rendered.blurred), camera, 5);
  }

  TrackedFrame track(const std::optional<double>& expected, double log_sigma) const {
    auto given = std::make_shared<Frame>(frame);
    given->exposure = expected;
    given->exposure_log_sigma = log_sigma;
    const double exposure = expected.value_or(TrackerConfig().unknown_exposure);
    MotionPrior prior;
    prior.dt = kInterval;
    prior.previous = {T_reference_mid * SE3::exp(-kInterval * velocity), velocity, exposure};
    return Tracker({}).track(*reference(), given, TrackingGuess(prior, exposure));
  }
};

constexpr double kUntoldSigma = 0.5;  // of log exposure

/// Rows tell how fast the camera moves, so the blur tells for how long it was exposed, whatever was expected.
TEST(RollingTracker, FindsTheExposureThatNobodyTold) {
  constexpr double kExposure = 0.02;  // [s]
  double worst = 0.0;
  for (unsigned seed = 1; seed <= kCases; ++seed) {
    const UntoldExposure untold(seed, kExposure);
    const Eigen::Vector3d turn = untold.velocity.tail<3>();
    for (const double wrong : {0.4, 0.7, 1.5}) {
      const TrackedFrame tracked = untold.track(wrong * kExposure, kUntoldSigma);
      ASSERT_TRUE(tracked.exposure_by_rows) << "seed " << seed;
      const double error = std::log(tracked.exposure_by_rows->exposure / kExposure);
      worst = std::max(worst, std::abs(error));
      EXPECT_LT(tracked.exposure_by_rows->log_sigma, 0.1);
      EXPECT_NEAR(std::log(tracked.trajectory.exposure / kExposure), error, 0.1) << "little is the expectation's";
      EXPECT_LT((tracked.trajectory.velocity.tail<3>() - turn).norm(), 0.1 * turn.norm());
      const SE3& found = tracked.trajectory.T_reference_mid;
      EXPECT_LT(test::meanReprojectionError(referenceView().depth, untold.T_reference_mid, found), 0.05)
          << "seed " << seed << ", taken for " << wrong << " times as long";
    }
    EXPECT_TRUE(untold.track(std::nullopt, 0.0).exposure_by_rows);
    const TrackedFrame told = untold.track(0.7 * kExposure, 0.0);
    EXPECT_FALSE(told.exposure_by_rows);
    EXPECT_EQ(told.trajectory.exposure, 0.7 * kExposure);
  }
  EXPECT_LT(worst, 0.12);
}

}  // namespace
}  // namespace mba_vo::rolling_tracker_test
