#include <gtest/gtest.h>

#include "mba_vo/tracking/tracker.h"
#include "support/random.h"
#include "support/rendered_room.h"

namespace mba_vo::lacking_correction_test {
namespace {

constexpr double kExposure = 0.02;  // [s]
constexpr double kFocalError = 0.01;

/// A reference, a blurred frame nearby as the renderer sees them, and where a search for the frame's motion begins.
struct Pair {
  const SimulatedFrame& view;
  SE3 T_reference_mid;
  SimulatedFrame rendered;
  ExposureTrajectory guess;
};

Pair pairOf(unsigned seed) {
  static const SimulatedFrame view = test::roomView(40);
  test::Random random(seed);
  const SE3 T_reference_mid = random.pose(0.06, 0.05);
  const Vector6 velocity = random.tangent(0.3, 1.5);
  const SimulatedFrame rendered = test::roomSimulator().renderExposure(
      test::constantVelocity(view.T_world_mid * T_reference_mid, velocity), 0.0, kExposure, seed);
  return {view, T_reference_mid, rendered, {T_reference_mid * random.pose(0.02, 0.01), velocity, kExposure}};
}

/// Mean error in the image [px].
double errorOf(const Pair& pair, const Reference& reference, const FrameConstPtr& frame) {
  const TrackedFrame tracked = Tracker({}).track(reference, frame, TrackingGuess(pair.guess));
  return test::meanReprojectionError(pair.view.depth, pair.T_reference_mid, tracked.trajectory.T_reference_mid);
}

/// Which of the two images was made before the vignette was known.
enum class Lacking { kReference, kFrame };

/// Of a frame tracked with `correction` as what is known of the vignette.
double errorWithVignette(Lacking lacking, const CalibrationCorrection& correction, unsigned seed) {
  const CalibrationCorrection::Vignette vignette(-0.35, -0.061, -0.014);
  const Pair pair = pairOf(seed);
  const auto seenBy = [&](const cv::Mat1f& image, Lacking which) {
    return lacking == which ? test::darkened(image, vignette) : image;
  };
  const cv::Mat1f sharp = test::toFloat(pair.view.sharp);
  auto reference = test::makeReference(pair.view, sharp);
  reference->pyramid =
      std::make_shared<const ImagePyramid>(seenBy(sharp, Lacking::kReference), test::roomSimulator().camera(), 5);
  reference->correction = correction;
  auto frame = std::make_shared<Frame>(
      *test::makeFrame(seenBy(test::toFloat(pair.rendered.blurred), Lacking::kFrame), 0, kExposure));
  (lacking == Lacking::kFrame ? reference->image_correction : frame->correction) = correction;
  return errorOf(pair, *reference, frame);
}

/// Of a frame that was made with a wrong focal length, tracked with `correction` as what is known of it by now.
double errorWithFocalLength(const CalibrationCorrection& correction, unsigned seed) {
  const Pair pair = pairOf(seed);
  auto reference = test::makeReference(pair.view, test::toFloat(pair.view.sharp));
  reference->correction = reference->image_correction = correction;
  auto frame = std::make_shared<Frame>(*test::makeFrame(test::toFloat(pair.rendered.blurred), 0, kExposure));
  PinholeCamera wrong = test::roomSimulator().camera();
  wrong.fx *= 1.0 + kFocalError;
  wrong.fy *= 1.0 + kFocalError;
  frame->pyramid = ImagePyramid(frame->pyramid.level(0).intensity, wrong, 5);
  return errorOf(pair, *reference, frame);
}

// What reference and frame lack of the vignette is taken account of.
TEST(Tracker, KnowsWhatImagesOfAnEarlierCorrectionLack) {
  CalibrationCorrection correction;
  correction.values.tail<3>() << -0.35, -0.061, -0.014;
  double known = 0.0;
  double unknown = 0.0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    for (const Lacking lacking : {Lacking::kReference, Lacking::kFrame}) {
      known += errorWithVignette(lacking, correction, seed) / 8.0;
      unknown += errorWithVignette(lacking, {}, seed) / 8.0;
    }
  }
  EXPECT_LT(known, 0.12);
  EXPECT_GT(unknown, 3.0 * known);
}

// The reference goes by a calibration that has been corrected since the frame was made.
TEST(Tracker, KnowsTheFocalLengthThatAnImageOfAnEarlierCorrectionHas) {
  CalibrationCorrection correction;
  correction.values(CalibrationCorrection::kFocal) = 1.0 / (1.0 + kFocalError) - 1.0;
  double known = 0.0;
  double unknown = 0.0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    known += errorWithFocalLength(correction, seed) / 4.0;
    unknown += errorWithFocalLength({}, seed) / 4.0;
  }
  EXPECT_LT(known, 0.025);
  EXPECT_GT(unknown, 5.0 * known);
}

}  // namespace
}  // namespace mba_vo::lacking_correction_test
