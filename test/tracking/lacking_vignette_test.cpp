#include <gtest/gtest.h>

#include "mba_vo/tracking/tracker.h"
#include "support/random.h"
#include "support/rendered_room.h"

namespace mba_vo {
namespace {

constexpr double kExposure = 0.02;  // [s]

/// Which of the two images was made before the vignette was known.
enum class Lacking { kReference, kFrame };

/// Mean error in the image [px] of a blurred frame, tracked with `correction` as what is known of the vignette.
double errorWith(Lacking lacking, const CalibrationCorrection& correction, unsigned seed) {
  const CalibrationCorrection::Vignette vignette(-0.35, -0.061, -0.014);
  static const SimulatedFrame view = test::roomSimulator().render(40);
  const auto seenBy = [&](const cv::Mat1f& image, Lacking which) {
    return lacking == which ? test::darkened(image, vignette) : image;
  };
  test::Random random(seed);
  const SE3 T_reference_mid = random.pose(0.06, 0.05);
  const Vector6 velocity = random.tangent(0.3, 1.5);
  const SimulatedFrame rendered = test::roomSimulator().renderExposure(
      test::constantVelocity(view.T_world_mid * T_reference_mid, velocity), 0.0, kExposure, seed);

  auto reference = test::makeReference(view, test::toFloat(view.sharp));
  reference->pyramid = std::make_shared<const ImagePyramid>(seenBy(test::toFloat(view.sharp), Lacking::kReference),
                                                            test::roomSimulator().camera(), 5);
  reference->correction = correction;
  auto frame =
      std::make_shared<Frame>(*test::makeFrame(seenBy(test::toFloat(rendered.blurred), Lacking::kFrame), 0, kExposure));
  (lacking == Lacking::kFrame ? reference->image_correction : frame->correction) = correction;

  ExposureTrajectory guess{T_reference_mid * random.pose(0.02, 0.01), velocity, kExposure};
  const TrackedFrame tracked = Tracker({}).track(*reference, frame, TrackingGuess(guess));
  return test::meanReprojectionError(view.depth, T_reference_mid, tracked.trajectory.T_reference_mid);
}

// What reference and frame lack of the vignette is taken account of.
TEST(Tracker, KnowsWhatImagesOfAnEarlierCorrectionLack) {
  CalibrationCorrection correction;
  correction.values.tail<3>() << -0.35, -0.061, -0.014;
  double known = 0.0;
  double unknown = 0.0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    for (const Lacking lacking : {Lacking::kReference, Lacking::kFrame}) {
      known += errorWith(lacking, correction, seed) / 8.0;
      unknown += errorWith(lacking, {}, seed) / 8.0;
    }
  }
  EXPECT_LT(known, 0.12);
  EXPECT_GT(unknown, 3.0 * known);
}

}  // namespace
}  // namespace mba_vo
