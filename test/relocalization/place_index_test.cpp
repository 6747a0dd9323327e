#include "mba_vo/relocalization/place_index.h"

#include <gtest/gtest.h>

#include "pose_graph/rendered_keyframes.h"

namespace mba_vo::place_index_test {
namespace {

using test::moved;

constexpr int kPlaces =
    9;  // that look elsewhere: the camera sees 82 degrees, and shifts are searched up to a third of it

SE3 place(int number) { return moved(test::roomSimulator().pose(1.0), 0.0, 0.0, 0.0, 40.0 * number); }

ImagePyramid view(const SE3& T_world_camera, double blur_px = 0.0, double gain = 1.0) {
  Vector6 velocity = Vector6::Zero();
  velocity(4) = blur_px / test::roomSimulator().camera().fx / test::kKeyframeExposure;
  const SimulatedFrame rendered = test::roomSimulator().renderExposure(test::constantVelocity(T_world_camera, velocity),
                                                                       0.0, test::kKeyframeExposure, 1);
  return ImagePyramid(test::scaled(test::toFloat(blur_px > 0.0 ? rendered.blurred : rendered.sharp), gain),
                      test::roomSimulator().camera(), 5);
}

PlaceIndex places(double blur_px = 0.0, int stride = 1) {
  PlaceIndex index;
  for (int i = 0; i < kPlaces; i += stride) {
    index.add(static_cast<KeyframeId>(i), PlaceDescriptor(view(place(i), blur_px)));
  }
  return index;
}

const auto kAll = [](KeyframeId) { return true; };

TEST(PlaceIndex, FindsThePlaceFromNearby) {
  const PlaceIndex index = places();
  for (int i = 0; i < kPlaces; ++i) {
    const PlaceDescriptor seen(view(moved(place(i), 0.2, -0.1, 0.2, 8.0), 0.0, 0.4));
    const std::vector<PlaceCandidate> found = index.search(seen, 3, kAll);
    ASSERT_EQ(found.size(), 3U);
    // The next view may have a part in common that is small and looks even more alike.
    const std::size_t rank = found[0].keyframe == static_cast<KeyframeId>(i) ? 0 : 1;
    EXPECT_EQ(found[rank].keyframe, static_cast<KeyframeId>(i));
    EXPECT_GT(found[rank].correlation, 0.6);
    EXPECT_GE(found[0].correlation, found[1].correlation);
  }
}

TEST(PlaceIndex, FindsItThroughBlur) {
  const PlaceIndex sharp = places(), blurred = places(20.0, 3);
  for (int i = 0; i < kPlaces; i += 3) {
    const PlaceDescriptor seen(view(moved(place(i), 0.1, 0.0, 0.1, -6.0), 20.0));
    EXPECT_EQ(sharp.search(seen, 1, kAll).front().keyframe, static_cast<KeyframeId>(i)) << "blurred to sharp";
    EXPECT_EQ(blurred.search(seen, 1, kAll).front().keyframe, static_cast<KeyframeId>(i)) << "blurred to blurred";
  }
}

TEST(PlaceIndex, TellsByHowMuchTheCameraHasTurned) {
  const PlaceIndex index = places();
  const double yaw = 9.0;  // [deg]
  const PlaceCandidate found =
      index.search(PlaceDescriptor(view(moved(place(3), 0.0, 0.0, 0.0, yaw))), 1, kAll).front();
  ASSERT_EQ(found.keyframe, 3U);
  EXPECT_NEAR(found.shift_px.x(), test::roomSimulator().camera().fx * std::tan(yaw * M_PI / 180.0), 12.0);
  EXPECT_NEAR(found.shift_px.y(), 0.0, 12.0);
}

TEST(PlaceIndex, ForgetsWhatIsRemovedAndLeavesOutWhatIsNotWanted) {
  PlaceIndex index = places();
  const PlaceDescriptor seen(view(place(4)));
  EXPECT_NE(index.search(seen, 1, [](KeyframeId id) { return id != 4; }).front().keyframe, 4U);
  index.remove(4);
  EXPECT_EQ(index.size(), kPlaces - 1U);
  EXPECT_NE(index.search(seen, 1, kAll).front().keyframe, 4U);
  const PlaceDescriptor last(view(place(kPlaces - 1)));  // it has moved to where the other one was
  EXPECT_EQ(index.search(last, 1, kAll).front().keyframe, kPlaces - 1U);
  for (KeyframeId id = 0; id < kPlaces; ++id) index.remove(id);
  EXPECT_TRUE(index.search(seen, 3, kAll).empty());
}

TEST(PlaceIndex, ADescriptorIsSmall) { EXPECT_LE(sizeof(PlaceDescriptor), 4000U); }

/// Nothing is like a plain wall, not even another one.
TEST(PlaceIndex, WhereNothingIsToBeSeenThereIsNoLikeness) {
  cv::Mat1f noise(240, 376);
  cv::theRNG().state = 1;
  cv::randn(noise, 100.0, 1.0);
  PlaceIndex index;
  index.add(1, PlaceDescriptor(ImagePyramid(noise, test::roomSimulator().camera(), 5)));
  const auto found = index.search(PlaceDescriptor(view(place(0))), 1, kAll);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_LT(found.front().correlation, 0.5);
}

}  // namespace
}  // namespace mba_vo::place_index_test
