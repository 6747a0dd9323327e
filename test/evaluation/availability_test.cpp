#include "mba_vo/evaluation/availability.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mba_vo::availability_test {
namespace {

/// 20 images per second from 5 s on, on a run clock that is 1000 s ahead.
OnlineFrame image(int index, OnlineStatus status, std::optional<double> latency) {
  const double time = 5.0 + 0.05 * index;
  const double arrival = time + 1000.0;
  const auto published = latency ? std::optional<double>(arrival + *latency) : std::nullopt;
  return {time, arrival, published, status, std::nullopt};
}

/// 40 images: 8 without anything, 2 with an orientation, then poses at once.
std::vector<OnlineFrame> usualRun() {
  std::vector<OnlineFrame> frames;
  for (int i = 0; i < 40; ++i) {
    frames.push_back(i < 8    ? image(i, OnlineStatus::kInitializing, std::nullopt)
                     : i < 10 ? image(i, OnlineStatus::kOrientation, 0.01)
                              : image(i, OnlineStatus::kTracking, 0.02));
  }
  return frames;
}

void expectShare(const Share& share, std::size_t count, std::size_t of) {
  EXPECT_EQ(share.count, count);
  EXPECT_EQ(share.of, of);
}

TEST(Availability, CountsPosesInTimeOfAllAndOfMovingImages) {
  const Availability a = measureAvailability(usualRun(), 5.1);  // image 2; 0.3 s later is image 8
  EXPECT_NEAR(a.frame_interval, 0.05, 1e-9);
  expectShare(a.pose_in_time, 30, 40);
  expectShare(a.pose_in_time_moving, 30, 31);
  expectShare(a.orientation_in_time, 32, 40);
  expectShare(a.orientation_in_time_moving, 31, 31);
  EXPECT_NEAR(a.first_pose_after_start.value(), 0.52, 1e-9);
  EXPECT_NEAR(a.first_pose_after_parallax.value(), 0.42, 1e-9);
  EXPECT_NEAR(a.longest_gap.value(), 0.05, 1e-9);
  expectShare(a.missed_after_first, 0, 29);
  EXPECT_EQ(a.images_by_status.at("ORIENTATION"), 2U);
  EXPECT_EQ(a.images_by_status.at("TRACKING"), 30U);
}

TEST(Availability, LatePosesDoNotCount) {
  std::vector<OnlineFrame> frames = usualRun();
  for (const int late : {20, 21, 22}) {
    frames[static_cast<std::size_t>(late)] = image(late, OnlineStatus::kTracking, 0.0501);
  }
  frames[30] = image(30, OnlineStatus::kDegraded, 0.05);  // just in time
  frames[31] = image(31, OnlineStatus::kTracking, std::nullopt);
  const Availability a = measureAvailability(frames, std::nullopt);
  expectShare(a.pose_in_time, 26, 40);
  expectShare(a.orientation_in_time, 28, 40);
  expectShare(a.pose_in_time_moving, 0, 0);
  expectShare(a.missed_after_first, 4, 29);
  EXPECT_NEAR(a.longest_gap.value(), 0.2, 1e-9);
  EXPECT_FALSE(a.first_pose_after_parallax.has_value());
}

TEST(Availability, LatencyIsThatOfPosesAlone) {
  std::vector<OnlineFrame> frames;
  frames.push_back(image(0, OnlineStatus::kOrientation, 9.0));
  for (int i = 1; i <= 101; ++i) {
    frames.push_back(image(i, OnlineStatus::kTracking, 0.001 * (102 - i)));
  }
  const Availability a = measureAvailability(frames, std::nullopt);
  EXPECT_NEAR(a.latency.median, 0.051, 1e-9);
  EXPECT_NEAR(a.latency.percentile_95, 0.096, 1e-9);
  EXPECT_NEAR(a.latency.percentile_99, 0.1, 1e-9);
}

TEST(Availability, ARunThatIsLostForGoodHasALongGap) {
  std::vector<OnlineFrame> frames = usualRun();
  for (int i = 15; i < 40; ++i) {
    frames[static_cast<std::size_t>(i)] = image(i, OnlineStatus::kLost, std::nullopt);
  }
  const Availability a = measureAvailability(frames, 5.1);
  EXPECT_NEAR(a.longest_gap.value(), 1.25, 1e-9);  // from image 14 to image 39
  expectShare(a.missed_after_first, 25, 29);
}

TEST(Availability, OrientationsAloneAreNoPoses) {
  std::vector<OnlineFrame> frames;
  for (int i = 0; i < 10; ++i) {
    frames.push_back(image(i, OnlineStatus::kOrientation, 0.01));
  }
  const Availability a = measureAvailability(frames, 5.0);
  expectShare(a.pose_in_time, 0, 10);
  expectShare(a.orientation_in_time, 10, 10);
  EXPECT_FALSE(a.first_pose_after_start.has_value());
  EXPECT_FALSE(a.longest_gap.has_value());
  EXPECT_TRUE(std::isnan(a.latency.median));
}

TEST(Availability, RepeatedStampsDoNotMakeTheIntervalShort) {
  std::vector<OnlineFrame> frames;
  for (int i = 0; i < 20; ++i) {  // every image twice
    frames.push_back(image(i, OnlineStatus::kTracking, 0.04));
    frames.push_back(image(i, OnlineStatus::kRejected, std::nullopt));
  }
  const Availability a = measureAvailability(frames, std::nullopt);
  EXPECT_NEAR(a.frame_interval, 0.05, 1e-9);
  expectShare(a.pose_in_time, 20, 40);
}

}  // namespace
}  // namespace mba_vo::availability_test
