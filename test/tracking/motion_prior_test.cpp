#include "mba_vo/tracking/motion_prior.h"

#include <cmath>

#include <gtest/gtest.h>

#include "mba_vo/tracking/motion_state.h"
#include "support/random.h"

namespace mba_vo::motion_prior_test {
namespace {

constexpr std::int64_t kInterval = 40'000'000;  // [ns]
constexpr double kDt = 0.04;                    // [s]
constexpr double kExposure = 0.02;              // [s]

double distance(const SE3& a, const SE3& b) { return (a.inverse() * b).log().norm(); }

/// Pose and velocity of a motion about a fixed axis with constant acceleration.
struct Accelerated {
  SE3 T0;
  Vector6 direction;
  double v0, a;
  SE3 pose(double t) const { return T0 * SE3::exp((v0 * t + 0.5 * a * t * t) * direction); }
  Vector6 velocity(double t) const { return (v0 + a * t) * direction; }
};

TEST(MotionPrior, PredictsConstantVelocityForwardsAndBackwards) {
  test::Random random(1);
  const SE3 T0 = random.pose(1.0, 1.0);
  const Vector6 v = random.tangent(1.0, 2.0);
  for (const double dt : {kDt, -kDt}) {
    MotionPrior prior;
    prior.previous = {T0, v, kExposure};
    prior.dt = dt;
    const ExposureTrajectory predicted = prior.predict(kExposure);
    EXPECT_LT(distance(predicted.T_reference_mid, T0 * SE3::exp(dt * v)), 1e-12);
    EXPECT_LT((predicted.velocity - v).norm(), 1e-12);
    EXPECT_EQ(predicted.exposure, kExposure);
    EXPECT_LT((prior.expectedXi(predicted.T_reference_mid, kExposure) - kExposure * v).norm(), 1e-12);
  }
}

TEST(MotionPrior, ExpectsTheTrueMotionUnderConstantAccelerationAndAtAReversal) {
  test::Random random(2);
  for (const double acceleration : {3.0, -100.0}) {  // the second turns round between the frames
    const Accelerated motion{random.pose(1.0, 1.0), random.tangent(1.0, 1.0), 2.0, acceleration};
    MotionPrior prior;
    prior.previous = {motion.pose(0.0), motion.velocity(0.0), kExposure};
    prior.dt = kDt;
    EXPECT_LT((prior.expectedXi(motion.pose(kDt), kExposure) - kExposure * motion.velocity(kDt)).norm(), 1e-9);
    prior.previous = {motion.pose(kDt), motion.velocity(kDt), kExposure};
    prior.dt = -kDt;
    EXPECT_LT((prior.expectedXi(motion.pose(0.0), kExposure) - kExposure * motion.velocity(0.0)).norm(), 1e-9);
  }
}

TEST(MotionPrior, TellsTheAccelerationFromTheMotionWithinTheExposure) {
  test::Random random(5);
  for (const double acceleration : {3.0, -100.0}) {
    const Accelerated motion{random.pose(1.0, 1.0), random.tangent(1.0, 1.0), 2.0, acceleration};
    const Vector6 expected = kExposure * kExposure * acceleration * motion.direction;
    MotionPrior prior;
    for (const double dt : {kDt, -kDt}) {
      prior.previous = {motion.pose(0.0), Vector6::Zero(), kExposure};
      prior.dt = dt;
      const Vector6 bend = prior.bend(motion.pose(dt), kExposure * motion.velocity(dt), kExposure);
      EXPECT_LT((bend - expected).norm(), 1e-9);
    }
  }
}

TEST(MotionPrior, OffersTheTrueStartOfSuddenChanges) {
  test::Random random(3);
  const Vector6 v = random.tangent(1.0, 2.0);
  const SE3 T0 = random.pose(1.0, 1.0);
  MotionPrior prior;
  prior.previous = {T0, v, kExposure};
  prior.acceleration = random.tangent(5.0, 20.0);
  prior.dt = kDt;
  const auto alternatives = prior.alternatives();
  const auto offers = [&](const SE3& pose) {
    for (const SE3& alternative : alternatives) {
      if (distance(alternative, pose) < 1e-12) return true;
    }
    return false;
  };
  EXPECT_TRUE(offers(T0)) << "stopped";
  EXPECT_TRUE(offers(T0 * SE3::exp(-kDt * v))) << "turned back";
  EXPECT_TRUE(offers(T0 * SE3::exp(2.0 * kDt * v))) << "twice as fast";
  EXPECT_TRUE(offers(T0 * SE3::exp(kDt * v + 0.5 * kDt * kDt * prior.acceleration))) << "constant acceleration";
}

TEST(MotionPrior, InformationIsTheInverseVarianceOfTheAccelerationsEffect) {
  MotionPriorConfig config;
  config.angular_acceleration = 10.0;
  config.linear_acceleration = 4.0;
  MotionPrior prior;
  prior.dt = kDt;
  const double depth = 2.5;
  const Vector6 pose = prior.poseInformation(config, depth);
  const Vector6 xi = prior.xiInformation(config, depth, kExposure, Vector6::Zero());
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::pow(pose(i), -0.5), 0.5 * kDt * kDt * 4.0 * depth, 1e-12);
    EXPECT_NEAR(std::pow(pose(3 + i), -0.5), 0.5 * kDt * kDt * 10.0, 1e-12);
    EXPECT_NEAR(std::pow(xi(i), -0.5), 0.5 * kDt * kExposure * 4.0 * depth, 1e-12);
    EXPECT_NEAR(std::pow(xi(3 + i), -0.5), 0.5 * kDt * kExposure * 10.0, 1e-12);
  }
  const Vector6 doubt = Vector6::LinSpaced(0.01, 0.06);
  const Vector6 doubtful = prior.xiInformation(config, depth, kExposure, doubt);
  EXPECT_TRUE(doubtful.cwiseInverse().isApprox(xi.cwiseInverse() + doubt.cwiseAbs2(), 1e-12));
  prior.dt = 2.0 * kDt;  // less is known after a longer time
  EXPECT_LT(prior.poseInformation(config, depth)(0), pose(0));
}

TrackedFrame trackedAt(std::int64_t ns, const ExposureTrajectory& trajectory, bool velocity_observed) {
  auto frame = std::make_shared<Frame>();
  frame->mid_exposure_ns = ns;
  frame->exposure = kExposure;
  TrackedFrame tracked;
  tracked.frame = frame;
  tracked.trajectory = trajectory;
  tracked.xi_prior_limited = !velocity_observed;
  return tracked;
}

TEST(MotionState, TakesTheVelocityFromTheBlurWhereThatTellsIt) {
  const Accelerated motion{SE3(), (Vector6() << 0.1, 0, 0, 0, 1.0, 0).finished(), 2.0, 15.0};
  MotionState state({motion.pose(0.0), motion.velocity(0.0), kExposure}, 0);
  state.update(trackedAt(kInterval, {motion.pose(kDt), motion.velocity(kDt), kExposure}, true));
  EXPECT_EQ(state.lastNs(), kInterval);
  EXPECT_LT((state.last().velocity - motion.velocity(kDt)).norm(), 1e-12);
  const MotionPrior prior = state.priorAt(2 * kInterval);
  EXPECT_NEAR(prior.dt, kDt, 1e-12);
  EXPECT_LT((prior.acceleration - 15.0 * motion.direction).norm(), 1e-9);
  EXPECT_LT(distance(prior.alternatives().front(), motion.pose(2 * kDt)), 1e-9);
}

TEST(MotionState, TakesTheVelocityFromThePosesWhereTheBlurIsTooShort) {
  const Vector6 v = (Vector6() << 0.1, 0.05, 0, 0, 0.2, 0.1).finished();
  const Vector6 nonsense = Vector6::Constant(9.0);
  MotionState state({SE3(), v, kExposure}, 0);
  state.update(trackedAt(kInterval, {SE3::exp(kDt * v), nonsense, kExposure}, false));
  EXPECT_LT((state.last().velocity - v).norm(), 1e-9);
  // The same for an exposure that is unknown, zero, or an estimate.
  for (const auto exposure : {std::optional<double>(), std::optional<double>(0.0), std::optional<double>(kExposure)}) {
    TrackedFrame tracked = trackedAt(2 * kInterval, {SE3::exp(2.0 * kDt * v), nonsense, kExposure}, true);
    auto frame = std::make_shared<Frame>(*tracked.frame);
    frame->exposure = exposure;
    if (exposure == kExposure) frame->exposure_log_sigma = 0.1;
    tracked.frame = frame;
    MotionState next = state;
    next.update(tracked);
    EXPECT_LT((next.last().velocity - v).norm(), 1e-9);
  }
}

TEST(MotionState, DoesNotTrustAVelocityForLong) {
  const Vector6 v = (Vector6() << 0, 0, 0, 0, 1.0, 0).finished();
  MotionState state({SE3(), v, kExposure}, 0);
  EXPECT_LT(state.priorAt(5'000'000'000).dt, 0.5);
  EXPECT_GT(state.priorAt(-5'000'000'000).dt, -0.5);
  // After a long gap nothing is known about the acceleration.
  state.update(trackedAt(5'000'000'000, {SE3(), -v, kExposure}, true));
  EXPECT_EQ(state.priorAt(5'000'000'000 + kInterval).acceleration.norm(), 0.0);
}

TEST(MotionState, GoesOnRelativeToAnotherReference) {
  test::Random random(5);
  const SE3 T_old = random.pose(1.0, 1.0);
  const Vector6 v = random.tangent(1.0, 1.0);
  const SE3 T_new_old = random.pose(1.0, 1.0);
  MotionState state({T_old, v, kExposure}, 0);
  state.changeReference(T_new_old);
  EXPECT_LT(distance(state.last().T_reference_mid, T_new_old * T_old), 1e-12);
  EXPECT_LT(distance(state.last().end(), T_new_old * T_old * SE3::exp(0.5 * kExposure * v)), 1e-12);
}

}  // namespace
}  // namespace mba_vo::motion_prior_test
