#include <gtest/gtest.h>

#include "mba_vo/tracking/tracker.h"
#include "support/random.h"
#include "support/rendered_room.h"

namespace mba_vo {
namespace {

constexpr double kExposure = 0.02;  // [s]
constexpr double kFocalError = 0.01;

/// Mean error in the image [px] of a blurred frame that was made with a wrong focal length, tracked with `correction`
/// as what is known of it by now.
double errorWith(const CalibrationCorrection& correction, unsigned seed) {
  static const SimulatedFrame view = test::roomSimulator().render(40);
  test::Random random(seed);
  const SE3 T_reference_mid = random.pose(0.06, 0.05);
  const Vector6 velocity = random.tangent(0.3, 1.5);
  const SimulatedFrame rendered = test::roomSimulator().renderExposure(
      test::constantVelocity(view.T_world_mid * T_reference_mid, velocity), 0.0, kExposure, seed);
  auto reference = test::makeReference(view, test::toFloat(view.sharp));
  reference->correction = reference->image_correction = correction;
  auto frame = std::make_shared<Frame>(*test::makeFrame(test::toFloat(rendered.blurred), 0, kExposure));
  PinholeCamera wrong = test::roomSimulator().camera();
  wrong.fx *= 1.0 + kFocalError;
  wrong.fy *= 1.0 + kFocalError;
  frame->pyramid = ImagePyramid(frame->pyramid.level(0).intensity, wrong, 5);
  const ExposureTrajectory guess{T_reference_mid * random.pose(0.02, 0.01), velocity, kExposure};
  const TrackedFrame tracked = Tracker({}).track(*reference, frame, TrackingGuess(guess));
  return test::meanReprojectionError(view.depth, T_reference_mid, tracked.trajectory.T_reference_mid);
}

// The reference goes by a calibration that has been corrected since the frame was made.
TEST(Tracker, KnowsTheFocalLengthThatAnImageOfAnEarlierCorrectionHas) {
  CalibrationCorrection correction;
  correction.values(CalibrationCorrection::kFocal) = 1.0 / (1.0 + kFocalError) - 1.0;
  double known = 0.0;
  double unknown = 0.0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    known += errorWith(correction, seed) / 4.0;
    unknown += errorWith({}, seed) / 4.0;
  }
  EXPECT_LT(known, 0.025);
  EXPECT_GT(unknown, 5.0 * known);
}

}  // namespace
}  // namespace mba_vo
