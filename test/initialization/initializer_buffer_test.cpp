#include "mba_vo/initialization/initializer_buffer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "support/rendered_room.h"

namespace mba_vo::initializer_buffer_test {
namespace {

constexpr double kExposure = 0.039;      // [s]
constexpr double kInterval = 0.04;       // [s]
constexpr double kStandsStill = 0.3;     // [s] at first: sharp images
constexpr double kTurn = 1.6;            // then [rad/s]: half a view in 10 images
constexpr double kBufferSeconds = 10.0;  // longer than this takes
constexpr int kCorners = 300;
constexpr int kImages = 40;
constexpr int kInView = 20;  // images

SE3 turned(double t) {
  Vector6 turn = Vector6::Zero();
  turn(4) = kTurn * std::max(0.0, t - kStandsStill);
  return SE3::exp(turn);
}

FrameConstPtr render(int index) {
  const SE3 T_world_start = test::roomSimulator().pose(1.0);
  const auto id = static_cast<std::uint64_t>(index);
  const SimulatedFrame rendered = test::roomSimulator().renderExposure(
      [&](double at) { return T_world_start * turned(at); }, kInterval * index, kExposure, id);
  return test::makeFrame(test::toFloat(rendered.blurred), std::llround(1e9 * kInterval * index), kExposure, id);
}

TEST(InitializerBuffer, AReferenceThatIsOutOfSightIsNeverChosenAgain) {
  InitializerBuffer buffer(kBufferSeconds, kCorners);
  int newest = 0;  // reference so far
  for (int i = 0; i < kImages; ++i) {
    buffer.add(render(i));
    buffer.updateReference();
    buffer.updateTracks(3);
    if (!buffer.hasReference()) continue;
    const int reference = static_cast<int>(buffer.images()[buffer.reference()].image->frame->sequence);
    EXPECT_GE(reference, newest) << "image " << i << ": images of before the turn are sharper, but see nothing of now";
    newest = std::max(newest, reference);
  }
  EXPECT_GT(newest, kImages - kInView);
}

}  // namespace
}  // namespace mba_vo::initializer_buffer_test
