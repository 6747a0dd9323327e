#include "mba_vo/tracking/exposure_probe.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/random.h"
#include "support/rendered_room.h"

namespace mba_vo::exposure_probe_test {
namespace {

constexpr double kExposure = 0.02;   // [s]
constexpr double kLongest = 0.05;    // [s]
constexpr double kWellKnown = 0.05;  // log sigma

const SimulatedFrame& referenceView() {
  static const SimulatedFrame view = test::roomView(40);
  return view;
}

std::shared_ptr<Reference> sharpReference() {
  return test::makeReference(referenceView(), test::toFloat(referenceView().sharp));
}

struct Case {
  TrackedFrame tracked;
  Vector6 velocity;
};

Case makeCase(unsigned seed, double rate) {
  test::Random random(seed);
  Case c;
  const SE3 T_reference_mid = random.pose(0.06, 0.05);
  c.velocity = rate * random.tangent(0.3, 1.0);
  const SimulatedFrame rendered = test::roomSimulator().renderExposure(
      test::constantVelocity(referenceView().T_world_mid * T_reference_mid, c.velocity), 0.0, kExposure, seed);
  c.tracked.frame = test::makeFrame(rendered, kExposure);
  c.tracked.trajectory = {T_reference_mid * random.pose(0.001, 0.0005), c.velocity, kExposure};
  return c;
}

TEST(ExposureProbe, FindsTheExposureFromWhateverItIsTakenFor) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Case c = makeCase(seed, 3.0);
    for (const double factor : {0.5, 1.0, 2.0}) {
      const auto sample =
          probeExposure(*sharpReference(), c.tracked, c.velocity, {factor * kExposure, kWellKnown}, kLongest, {});
      ASSERT_TRUE(sample) << "seed " << seed << " from " << factor;
      EXPECT_NEAR(sample->exposure, kExposure, 0.04 * kExposure) << "seed " << seed << " from " << factor;
      EXPECT_LT(sample->log_sigma, 0.05);
    }
  }
}

TEST(ExposureProbe, LooksFurtherWhereLittleIsKnown) {
  const Case c = makeCase(1, 3.0);
  for (const double expected : {0.001, 0.045}) {
    const auto sample = probeExposure(*sharpReference(), c.tracked, c.velocity, {expected, 1.0}, kLongest, {});
    ASSERT_TRUE(sample) << "from " << expected;
    EXPECT_NEAR(sample->exposure, kExposure, 0.04 * kExposure) << "from " << expected;
  }
}

TEST(ExposureProbe, TakesAReferenceWithBlurAsExposedAsLong) {
  const Case c = makeCase(5, 3.0);
  const Vector6 velocity = 0.6 * c.velocity;
  const SimulatedFrame blurred = test::roomSimulator().renderExposure(
      test::constantVelocity(referenceView().T_world_mid, velocity), 0.0, kExposure, 6);
  const auto reference = test::makeReference(referenceView(), test::toFloat(blurred.blurred));
  reference->motion.velocity = velocity;
  // Half the exposure was believed, or it was not known and the image taken for sharp.
  for (const double believed : {0.5 * kExposure, 0.0}) {
    reference->image_xi = believed * velocity;
    TrackedFrame tracked = c.tracked;
    tracked.frame = test::withExposure(*c.tracked.frame, believed > 0.0 ? std::optional(believed) : std::nullopt);
    const auto sample = probeExposure(*reference, tracked, c.velocity, {0.5 * kExposure, kWellKnown}, kLongest, {});
    ASSERT_TRUE(sample);
    EXPECT_NEAR(sample->exposure, kExposure, 0.05 * kExposure);
  }
}

TEST(ExposureProbe, SaysNothingWhereNothingIsBlurred) {
  const Case c = makeCase(1, 0.01);
  EXPECT_FALSE(probeExposure(*sharpReference(), c.tracked, c.velocity, {kExposure, kWellKnown}, kLongest, {}));
}

}  // namespace
}  // namespace mba_vo::exposure_probe_test
