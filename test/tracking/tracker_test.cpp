#include "mba_vo/tracking/tracker.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/random.h"
#include "support/rendered_room.h"

namespace mba_vo::tracker_test {
namespace {

constexpr double kExposure = 0.02;  // [s]
constexpr double kRadiansPerDegree = 0.017453292519943295;

const SimulatedFrame& referenceView() {
  static const SimulatedFrame view = test::roomView(40);
  return view;
}

ReferenceConstPtr sharpReference() {
  static const ReferenceConstPtr reference = test::makeReference(referenceView(), test::toFloat(referenceView().sharp));
  return reference;
}

/// A frame seen some way off the reference, moving so that points at 2 m leave a trace of about `blur_px`.
struct Case {
  SE3 T_reference_mid;
  Vector6 velocity;
  SimulatedFrame rendered;
  FrameConstPtr frame;
};

Case makeCase(unsigned seed, double blur_px) {
  test::Random random(seed);
  Case c;
  c.T_reference_mid = random.pose(0.06, 0.05);
  Vector6 direction = random.tangent(0.6, 1.0);
  direction(5) *= 0.5;
  const SE3 T_world_mid = referenceView().T_world_mid * c.T_reference_mid;
  const SE3 half = SE3::exp(0.005 * direction);
  SimulatedFrame unit;
  unit.T_world_mid = SE3();
  unit.T_world_start = half.inverse();
  unit.T_world_end = half;
  const double px_per_unit = blurAtTwoMetres(test::roomSimulator().camera(), unit) / 0.01;
  c.velocity = blur_px / px_per_unit / kExposure * direction;
  c.rendered =
      test::roomSimulator().renderExposure(test::constantVelocity(T_world_mid, c.velocity), 0.0, kExposure, seed);
  c.frame = test::makeFrame(c.rendered, kExposure);
  return c;
}

/// Up to a degree and a few centimetres off, with the velocity of a moment ago: violent shaking changes it by half a
/// radian per second from frame to frame.
TrackingGuess wrongGuess(const Case& c, unsigned seed) {
  test::Random random(seed + 1000);
  ExposureTrajectory guess{c.T_reference_mid * random.pose(0.03, 0.01), Vector6::Zero(), c.frame->exposure.value()};
  guess.velocity = c.velocity + random.tangent(0.3, 0.5);
  return guess;
}

SE3 trueMotion(const Case& c) { return c.rendered.T_world_start.inverse() * c.rendered.T_world_end; }

class TrackerAtBlur : public testing::TestWithParam<double> {};

TEST_P(TrackerAtBlur, RecoversMidStartAndEndFromAPerturbedGuess) {
  const Tracker tracker({});
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Case c = makeCase(seed, GetParam());
    ASSERT_NEAR(c.rendered.blur_px, GetParam(), 0.1 + 0.1 * GetParam());
    const TrackedFrame tracked = tracker.track(*sharpReference(), c.frame, wrongGuess(c, seed));
    EXPECT_TRUE(tracked.tracked()) << tracked.reason;
    EXPECT_EQ(tracked.frame, c.frame);
    const double mid =
        test::meanReprojectionError(referenceView().depth, c.T_reference_mid, tracked.trajectory.T_reference_mid);
    EXPECT_LT(mid, 0.1) << "seed " << seed;
    // A blurred image looks the same with its ends exchanged.
    const SE3 T_start_end = SE3::exp(tracked.trajectory.xi());
    const auto as_found = test::borderError(T_start_end, trueMotion(c));
    const auto exchanged = test::borderError(T_start_end.inverse(), trueMotion(c));
    const double motion = std::min(as_found.mean, exchanged.mean);
    EXPECT_LT(motion, std::max(1.5, 0.08 * as_found.true_length)) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Pixels, TrackerAtBlur, testing::Values(0.0, 5.0, 10.0, 20.0));

TEST(Tracker, KnowsTheSignFromThePreviousFrame) {
  const Simulator& simulator = test::roomSimulator();
  constexpr double kStep = 1e-4;  // [s]
  int blurred = 0;
  for (int index = 42; index <= 54; ++index) {
    const SimulatedFrame reference_view = test::roomView(index - 3);
    const ReferenceConstPtr reference = test::makeReference(reference_view, test::toFloat(reference_view.sharp));
    const SimulatedFrame rendered = test::roomView(index);
    MotionPrior prior;
    prior.dt = simulator.time(index) - simulator.time(index - 1);
    const double t = simulator.time(index - 1);
    const SE3 T_reference_world = reference_view.T_world_mid.inverse();
    prior.previous = {T_reference_world * simulator.pose(t),
                      (simulator.pose(t - kStep).inverse() * simulator.pose(t + kStep)).log() / (2 * kStep), kExposure};
    const TrackedFrame tracked =
        Tracker({}).track(*reference, test::makeFrame(rendered, kExposure), TrackingGuess(prior, kExposure));
    EXPECT_EQ(tracked.status, TrackingStatus::kTracking) << tracked.reason;
    const SE3 truth = T_reference_world * rendered.T_world_mid;
    const double mid = test::meanReprojectionError(reference_view.depth, truth, tracked.trajectory.T_reference_mid);
    EXPECT_LT(mid, 0.1) << "frame " << index;
    const auto error =
        test::borderError(SE3::exp(tracked.trajectory.xi()), rendered.T_world_start.inverse() * rendered.T_world_end);
    EXPECT_LT(error.mean, std::max(1.0, 0.1 * error.true_length)) << "frame " << index;
    blurred += error.true_length > 4.0 ? 1 : 0;
  }
  EXPECT_GE(blurred, 5);  // where the sign matters
}

TEST(Tracker, BelievesTheBlurRatherThanAnExposureThatNobodyTold) {
  constexpr double kWrong = 2.0 * kExposure;
  TrackerConfig config;
  config.max_points = 40;  // that the prior counts
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Case c = makeCase(seed, 6.0);
    MotionPrior prior;
    prior.dt = 0.033;
    prior.previous = {c.T_reference_mid * SE3::exp(-prior.dt * c.velocity), c.velocity, kExposure};
    const auto errorWith = [&](double exposure_log_sigma) {
      const FrameConstPtr frame = withExposure(c.frame, kWrong, exposure_log_sigma);
      const TrackedFrame tracked = Tracker(config).track(*sharpReference(), frame, TrackingGuess(prior, kWrong));
      return test::borderError(SE3::exp(tracked.trajectory.xi()), trueMotion(c)).mean;
    };
    EXPECT_LT(errorWith(0.1), 0.4) << "seed " << seed;
    EXPECT_GT(errorWith(0.0), 0.8) << "seed " << seed << ", told";
  }
}

// The camera stood still and turns all of a sudden.
TEST(Tracker, FindsATurnThatNothingPredicted) {
  MotionPrior prior;
  prior.dt = 1.0 / 27.0;
  prior.previous = {SE3(), Vector6::Zero(), kExposure};
  for (const unsigned seed : {3, 4, 6}) {
    Vector6 turn = Vector6::Zero();
    turn.tail<3>() = 8.0 * kRadiansPerDegree * test::Random(seed).tangent(0.0, 1.0).tail<3>().normalized();
    const auto motion = test::constantVelocity(referenceView().T_world_mid * SE3::exp(turn), turn / prior.dt);
    const SimulatedFrame rendered = test::roomSimulator().renderExposure(motion, 0.0, kExposure, seed);
    const TrackedFrame tracked =
        Tracker({}).track(*sharpReference(), test::makeFrame(rendered, kExposure), TrackingGuess(prior, kExposure));
    EXPECT_EQ(tracked.status, TrackingStatus::kTracking) << tracked.reason;
    const double mid =
        test::meanReprojectionError(referenceView().depth, SE3::exp(turn), tracked.trajectory.T_reference_mid);
    EXPECT_LT(mid, 0.5) << "seed " << seed;
  }
}

TEST(Tracker, AlignsSharpFramesWithoutMotionInTheExposure) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Case c = makeCase(seed, 0.0);
    c.frame = test::makeFrame(c.rendered, 0.0);
    TrackingGuess guess = wrongGuess(c, seed);
    const Vector6 velocity = guess.trajectory.velocity;
    const TrackedFrame tracked = Tracker({}).track(*sharpReference(), c.frame, guess);
    EXPECT_EQ(tracked.status, TrackingStatus::kTracking) << tracked.reason;
    EXPECT_EQ(tracked.trajectory.xi().norm(), 0.0);
    EXPECT_EQ(tracked.trajectory.velocity, velocity);  // for the next prediction
    EXPECT_TRUE(tracked.xi_prior_limited);
    const double mid =
        test::meanReprojectionError(referenceView().depth, c.T_reference_mid, tracked.trajectory.T_reference_mid);
    EXPECT_LT(mid, 0.08) << "seed " << seed;
  }
}

TEST(Tracker, WithoutTheBlurModelABlurredFrameIsAlignedWorse) {
  double with_model = 0.0;
  double without_model = 0.0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Case c = makeCase(seed, 15.0);
    TrackingGuess guess = wrongGuess(c, seed);
    const auto error = [&](const TrackedFrame& t) {
      return test::meanReprojectionError(referenceView().depth, c.T_reference_mid, t.trajectory.T_reference_mid);
    };
    with_model += error(Tracker({}).track(*sharpReference(), c.frame, guess));
    guess.trajectory.exposure = 0.0;
    without_model += error(Tracker({}).track(*sharpReference(), c.frame, guess));
  }
  EXPECT_LT(with_model, 0.5 * without_model);
}

TEST(Tracker, RecoversAChangeOfBrightness) {
  const Case c = makeCase(3, 6.0);
  cv::Mat1f darker;
  c.rendered.blurred.convertTo(darker, CV_32F, 0.7, 12.0);
  const FrameConstPtr frame = test::makeFrame(darker, 0, kExposure);
  auto reference = std::make_shared<Reference>(*sharpReference());
  for (const AffineBrightness of_reference : {AffineBrightness{0.0, 0.0}, AffineBrightness{0.3, -8.0}}) {
    reference->brightness = of_reference;
    TrackingGuess guess = wrongGuess(c, 3);
    guess.brightness = of_reference;
    const TrackedFrame tracked = Tracker({}).track(*reference, frame, guess);
    EXPECT_EQ(tracked.status, TrackingStatus::kTracking) << tracked.reason;
    // frame = 0.7 reference + 12 and reference = e^a map + b, so frame = 0.7 e^a map + 0.7 b + 12.
    EXPECT_NEAR(tracked.brightness.a, std::log(0.7) + of_reference.a, 0.02);
    EXPECT_NEAR(tracked.brightness.b, 0.7 * of_reference.b + 12.0, 2.0);
    EXPECT_LT(test::meanReprojectionError(referenceView().depth, c.T_reference_mid, tracked.trajectory.T_reference_mid),
              0.25);
  }
}

TEST(Tracker, AFrameOfSomethingElseIsLost) {
  for (const double yaw : {1.6, 3.1, 4.7}) {  // [rad]
    Vector6 turn = Vector6::Zero();
    turn(4) = yaw;
    const SimulatedFrame elsewhere = test::roomSimulator().renderExposure(
        test::constantVelocity(referenceView().T_world_mid * SE3::exp(turn), Vector6::Zero()), 0.0, kExposure);
    const TrackedFrame tracked = Tracker({}).track(*sharpReference(), test::makeFrame(elsewhere, kExposure),
                                                   ExposureTrajectory{SE3(), Vector6::Zero(), kExposure});
    EXPECT_EQ(tracked.status, TrackingStatus::kLost) << "inliers " << tracked.inlier_fraction;
    EXPECT_FALSE(tracked.reason.empty());
  }
}

TEST(Tracker, AnImageWithoutTextureIsLost) {
  for (const float grey : {0.0F, 90.0F, 255.0F}) {  // the lens is covered, or the light is too bright
    cv::Mat1f image(240, 376);
    cv::RNG(1).fill(image, cv::RNG::NORMAL, grey, 1.0);
    const TrackedFrame tracked = Tracker({}).track(*sharpReference(), test::makeFrame(image, 0, kExposure),
                                                   ExposureTrajectory{SE3(), Vector6::Zero(), kExposure});
    EXPECT_EQ(tracked.status, TrackingStatus::kLost) << "grey " << grey << ", gain " << tracked.brightness.a;
    EXPECT_FALSE(tracked.reason.empty());
  }
}

TEST(Tracker, TooFewPointsAreLost) {
  const Case c = makeCase(1, 5.0);
  auto reference = std::make_shared<Reference>(*sharpReference());
  reference->points.resize(12);
  TrackedFrame tracked = Tracker({}).track(*reference, c.frame, wrongGuess(c, 1));
  EXPECT_EQ(tracked.status, TrackingStatus::kLost);
  EXPECT_NE(tracked.reason.find("patches"), std::string::npos) << tracked.reason;
  reference->points.clear();
  tracked = Tracker({}).track(*reference, c.frame, wrongGuess(c, 1));
  EXPECT_EQ(tracked.status, TrackingStatus::kLost);
  EXPECT_FALSE(tracked.reason.empty());
}

TEST(Tracker, APoseThatIsHardlyKnownIsDegraded) {
  const Case c = makeCase(2, 10.0);
  const TrackingGuess guess(ExposureTrajectory{c.T_reference_mid, c.velocity, kExposure});
  const TrackedFrame usual = Tracker({}).track(*sharpReference(), c.frame, guess);
  EXPECT_EQ(usual.status, TrackingStatus::kTracking) << usual.reason;
  EXPECT_GT(usual.expected_error, 0.01);
  EXPECT_LT(usual.expected_error, 0.2);
  TrackerConfig config;
  config.degraded_expected_error = 0.9 * usual.expected_error;
  const TrackedFrame strict = Tracker(config).track(*sharpReference(), c.frame, guess);
  EXPECT_EQ(strict.status, TrackingStatus::kDegraded);
  EXPECT_NE(strict.reason.find("known to"), std::string::npos) << strict.reason;
}

TEST(Tracker, ABlurredReferenceDoesNotBiasTheMotion) {
  // Both images are blurred along different paths; what the reference's own blur is has to be known.
  double known = 0.0;
  double unknown = 0.0;
  for (unsigned seed = 11; seed <= 14; ++seed) {
    const Case c = makeCase(seed, 8.0);
    const Vector6 reference_velocity = makeCase(seed + 50, 8.0).velocity;
    SimulatedFrame blurred_view = test::roomSimulator().renderExposure(
        test::constantVelocity(referenceView().T_world_mid, reference_velocity), 0.0, kExposure, seed);
    const auto reference = test::makeReference(blurred_view, test::toFloat(blurred_view.blurred));
    const auto errorOf = [&](const Vector6& image_xi, double& total) {
      reference->image_xi = image_xi;
      const TrackedFrame tracked = Tracker({}).track(*reference, c.frame, wrongGuess(c, seed));
      EXPECT_TRUE(tracked.tracked()) << tracked.reason;
      const double mid =
          test::meanReprojectionError(referenceView().depth, c.T_reference_mid, tracked.trajectory.T_reference_mid);
      const SE3 T_start_end = SE3::exp(tracked.trajectory.xi());
      const auto as_found = test::borderError(T_start_end, trueMotion(c));
      const double motion = std::min(as_found.mean, test::borderError(T_start_end.inverse(), trueMotion(c)).mean);
      total += motion;
      return std::make_pair(mid, motion / as_found.true_length);
    };
    const auto [mid, motion] = errorOf(kExposure * reference_velocity, known);
    EXPECT_LT(mid, 0.1) << "seed " << seed;
    EXPECT_LT(motion, 0.06) << "seed " << seed;
    errorOf(Vector6::Zero(), unknown);
  }
  EXPECT_LT(known, 0.2 * unknown);
}

}  // namespace
}  // namespace mba_vo::tracker_test
