#include "mba_vo/tracking/exposure_estimator.h"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/rendered_room.h"

namespace mba_vo::exposure_estimator_test {
namespace {

constexpr double kExposure = 0.02;           // [s]
constexpr double kFound = 0.93 * kExposure;  // where it is untold: as short as it may well be
constexpr double kInterval = 0.03;           // [s]
constexpr int kFrames = 16;
constexpr std::int64_t kEnd_ns = 450000000;  // of the last frame
constexpr double kRate = 9.0;                // [rad/s]
const Vector6 kSwing = (Vector6() << 0.05, 0, 0, 0.04, 0.12, 0).finished();
const SE3 kT_other_first = SE3::exp((Vector6() << 0.01, 0.02, 0, 0.01, 0, 0.02).finished());

/// A camera that swings to and fro before the room, seen from two references in turn, with the true poses. The exposure
/// of the last frame is `growth` times as long as that of the first, kExposure.
struct Swing {
  std::vector<ReferenceConstPtr> references;
  std::vector<TrackedFrame> frames;

  explicit Swing(double growth = 1.0) {
    const SimulatedFrame view = test::roomView(40);
    const SE3 T_world_other = view.T_world_mid * kT_other_first.inverse();
    const SimulatedFrame other =
        test::roomSimulator().renderExposure([&](double) { return T_world_other; }, 0.0, 0.0, 1);
    references = {test::makeReference(view, test::toFloat(view.sharp)),
                  test::makeReference(other, test::toFloat(other.sharp))};
    const auto pose = [&](double t) { return view.T_world_mid * SE3::exp(std::sin(kRate * t) * kSwing); };
    for (int i = 0; i < kFrames; ++i) {
      const SimulatedFrame rendered = test::roomSimulator().renderExposure(
          pose, kInterval * i, kExposure * std::pow(growth, i / (kFrames - 1.0)), static_cast<unsigned>(i));
      TrackedFrame tracked;
      tracked.frame = test::makeFrame(test::toFloat(rendered.blurred), std::llround(1e9 * kInterval * i), kExposure);
      tracked.status = TrackingStatus::kTracking;
      const SE3 T_first_mid = view.T_world_mid.inverse() * rendered.T_world_mid;
      tracked.trajectory.T_reference_mid = i % 2 == 0 ? T_first_mid : kT_other_first * T_first_mid;
      frames.push_back(tracked);
    }
  }
};

/// What the estimator makes of it if `given` comes with the images.
ExposureEstimator estimate(const std::optional<double>& given, const TrackerConfig& config = {},
                           const Swing& swing = Swing()) {
  ExposureEstimator estimator(config);
  for (std::size_t i = 0; i < swing.frames.size(); ++i) {
    auto tracked = std::make_shared<TrackedFrame>(swing.frames[i]);
    tracked->frame = test::withExposure(*tracked->frame, estimator.exposureFor(given, tracked->frame->mid_exposure_ns));
    if (i > 0) estimator.changeReference(i % 2 == 1 ? kT_other_first : kT_other_first.inverse());
    estimator.add(swing.references[i % 2], tracked, given);
  }
  return estimator;
}

TEST(ExposureEstimator, FindsAnUnknownExposure) {
  const ExposureEstimator estimator = estimate(std::nullopt);
  EXPECT_TRUE(estimator.estimate(false, kEnd_ns).used);
  const auto found = estimator.exposureFor(std::nullopt, kEnd_ns);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, kFound, 0.06 * kExposure);
  EXPECT_LT(estimator.estimate(false, kEnd_ns).log_sigma, 0.1);
}

TEST(ExposureEstimator, BeginsWithWhatAFirstMapKnows) {
  ExposureEstimator estimator{TrackerConfig()};
  estimator.learn(kEnd_ns, {kExposure, 0.1});
  EXPECT_NEAR(estimator.exposureFor(std::nullopt, kEnd_ns).value_or(0.0), kExposure, 0.02 * kExposure);
  EXPECT_NEAR(estimator.estimate(false, kEnd_ns).log_sigma, 0.1, 0.01);
  EXPECT_EQ(estimator.exposureFor(0.5 * kExposure, kEnd_ns), 0.5 * kExposure) << "one that came";
  ASSERT_TRUE(estimator.history());
  EXPECT_NEAR(estimator.history()->exposureAt(1e-9 * kEnd_ns), kExposure, 0.02 * kExposure);
  estimator.learn(kEnd_ns - 1, {5.0 * kExposure, 0.1});
  EXPECT_NEAR(estimator.exposureFor(std::nullopt, kEnd_ns).value_or(0.0), kExposure, 0.02 * kExposure) << "of before";
}

TEST(ExposureEstimator, FindsAnUnknownExposureThatIsFarFromTheAssumedOne) {
  TrackerConfig config;
  config.unknown_exposure = 0.1 * kExposure;
  const ExposureEstimator estimator = estimate(std::nullopt, config);
  EXPECT_NEAR(estimator.exposureFor(std::nullopt, kEnd_ns).value_or(0.0), kFound, 0.06 * kExposure);
}

TEST(ExposureEstimator, FollowsAnUnknownExposureThatChanges) {
  const ExposureEstimator estimator = estimate(std::nullopt, {}, Swing(0.5));
  const auto found = estimator.exposureFor(std::nullopt, kEnd_ns);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 0.5 * kExposure, 0.2 * 0.5 * kExposure);
}

TEST(ExposureEstimator, CorrectsExposuresThatAreWrongByAFactor) {
  for (const double factor : {0.5, 2.0}) {
    const double given = factor * kExposure;
    const ExposureEstimator estimator = estimate(given);
    EXPECT_TRUE(estimator.estimate(true, kEnd_ns).used);
    EXPECT_NEAR(estimator.exposureFor(given, kEnd_ns).value_or(0.0), kExposure, 0.06 * kExposure)
        << "factor " << factor;
  }
}

TEST(ExposureEstimator, LeavesRightExposuresAsTheyAre) {
  const ExposureEstimator estimator = estimate(kExposure);
  EXPECT_FALSE(estimator.estimate(true, kEnd_ns).used);
  EXPECT_NEAR(estimator.estimate(true, kEnd_ns).ratio, 1.0, 0.06);
  EXPECT_EQ(estimator.exposureFor(kExposure, kEnd_ns), kExposure);
  EXPECT_EQ(estimator.exposureFor(0.0, kEnd_ns), 0.0);
}

TEST(ExposureEstimator, LearnsNothingFromReferencesThatAreBlurredLikeTheFrames) {
  Swing swing;
  ExposureEstimator estimator{TrackerConfig()};
  for (std::size_t i = 0; i < swing.frames.size(); ++i) {
    Reference reference = *swing.references[0];
    reference.image_xi = kExposure * kRate * std::cos(kRate * kInterval * (static_cast<double>(i) - 2.0)) * kSwing;
    swing.frames[i].trajectory.T_reference_mid =
        SE3::exp(std::sin(kRate * kInterval * static_cast<double>(i)) * kSwing);
    estimator.add(std::make_shared<Reference>(reference), std::make_shared<TrackedFrame>(swing.frames[i]), kExposure);
  }
  EXPECT_EQ(estimator.estimate(true, kEnd_ns).log_sigma, std::numeric_limits<double>::infinity());
}

/// A frame by a rolling shutter whose rows told the exposure. `alike`: the reference's own blur over that of the frame.
std::pair<ReferenceConstPtr, std::shared_ptr<TrackedFrame>> byRows(double time, const ExposureSample& sample,
                                                                   double alike) {
  const SimulatedFrame view = test::roomView(40);
  Reference reference = *test::makeReference(view, test::toFloat(view.sharp));
  auto tracked = std::make_shared<TrackedFrame>();
  PinholeCamera camera = test::roomSimulator().camera();
  camera.row_time = 110e-6;
  auto frame = std::make_shared<Frame>();
  frame->pyramid = ImagePyramid(test::toFloat(view.sharp), camera, 1);
  frame->mid_exposure_ns = std::llround(1e9 * time);
  frame->exposure = sample.exposure;
  tracked->frame = frame;
  tracked->status = TrackingStatus::kTracking;
  tracked->trajectory = {SE3(), kRate * kSwing, sample.exposure};
  tracked->exposure_by_rows = sample;
  reference.image_xi = alike * sample.exposure * kRate * kSwing;
  return {std::make_shared<Reference>(reference), tracked};
}

TEST(ExposureEstimator, BelievesWhatRowsTellFrameByFrame) {
  ExposureEstimator estimator{TrackerConfig()};
  const auto now = [&](double time) { return estimator.exposureFor(std::nullopt, std::llround(1e9 * time)); };
  const auto add = [&](double time, double exposure, double alike) {
    const auto [reference, tracked] = byRows(time, {exposure, 0.03}, alike);
    estimator.add(reference, tracked, std::nullopt);
  };
  add(1.0, kExposure, 1.3);
  EXPECT_FALSE(now(1.0)) << "blurred along the reference's own, longer blur: it tells as little as that is known";
  for (int i = 0; i < 10; ++i) add(1.0 + kInterval * i, kExposure * std::pow(0.95, i), 0.0);
  EXPECT_NEAR(std::log(now(1.0 + 9 * kInterval).value_or(1.0) / kExposure), 9 * std::log(0.95) - 0.03, 0.03);
  for (int i = 10; i < 40; ++i) add(1.0 + kInterval * i, 10.0, 0.0);
  EXPECT_NEAR(std::log(now(1.0 + 39 * kInterval).value_or(10.0) / kInterval), -0.03, 0.05) << "more than the interval";
}

TEST(ExposureEstimator, KeepsStillWhenToldTo) {
  TrackerConfig config;
  config.estimate_exposure = false;
  EXPECT_FALSE(estimate(std::nullopt, config).exposureFor(std::nullopt, kEnd_ns));
  EXPECT_EQ(estimate(2.0 * kExposure, config).exposureFor(2.0 * kExposure, kEnd_ns), 2.0 * kExposure);
}

}  // namespace
}  // namespace mba_vo::exposure_estimator_test
