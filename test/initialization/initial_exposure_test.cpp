#include "mba_vo/initialization/initial_exposure.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/rendered_room.h"

namespace mba_vo::initial_exposure_test {
namespace {

constexpr double kExposure = 0.02;  // [s]
constexpr double kInterval = 0.03;  // [s]
constexpr int kFrames = 9;
constexpr double kRate = 9.0;  // [rad/s]

/// A camera that swings to and fro before the room, as a map would begin with it: true poses and depths, and images of
/// which nobody tells how long they were exposed. The reference is that of number `reference`.
InitialMap swing(int reference, double width, double exposure) {
  const Vector6 swing = width * (Vector6() << 0.05, 0, 0, 0.04, 0.12, 0).finished();
  const SimulatedFrame view = test::roomView(40);
  const auto pose = [&](double t) { return view.T_world_mid * SE3::exp(std::sin(kRate * t) * swing); };
  InitialMap map;
  SE3 T_world_reference;
  for (const bool others : {false, true}) {
    for (int i = 0; i < kFrames; ++i) {
      if ((i != reference) != others) continue;
      const SimulatedFrame rendered =
          test::roomSimulator().renderExposure(pose, kInterval * i, exposure, static_cast<unsigned>(i));
      const FrameConstPtr frame =
          test::makeFrame(test::toFloat(rendered.blurred), std::llround(1e9 * kInterval * i), std::nullopt);
      if (others) {
        map.poses.push_back({frame, T_world_reference.inverse() * rendered.T_world_mid});
        continue;
      }
      T_world_reference = rendered.T_world_mid;
      map.reference = frame;
      map.points = test::makeReference(rendered, test::toFloat(rendered.blurred))->points;
    }
  }
  return map;
}

TEST(InitialExposure, IsToldByTheBlurOfFramesWithPoses) {
  // A reference at the turn is sharp, one in the middle of the way blurred, the first one has none before it.
  for (const int reference : {0, 4, 6}) {
    for (const double exposure : {0.5 * kExposure, kExposure}) {
      const auto found = initialExposure(swing(reference, 1.0, exposure), {});
      ASSERT_TRUE(found) << "reference " << reference;
      // It is taken for as short as it may well be.
      EXPECT_LT(found->exposure, 1.02 * exposure) << "reference " << reference;
      EXPECT_GT(found->exposure, 0.84 * exposure) << "reference " << reference;
      EXPECT_LT(found->log_sigma, 0.15);
      EXPECT_GT(found->log_sigma, 0.049);
    }
  }
}

TEST(InitialExposure, IsUnknownWhereNothingIsBlurredOrTooFewFramesAreKnown) {
  EXPECT_FALSE(initialExposure(swing(4, 0.01, kExposure), {}));
  InitialMap map = swing(4, 1.0, kExposure);
  map.poses.resize(1);
  EXPECT_FALSE(initialExposure(map, {}));
}

}  // namespace
}  // namespace mba_vo::initial_exposure_test
