#include "mba_vo/odometry/recent_frames.h"

#include <gtest/gtest.h>

namespace mba_vo::recent_frames_test {
namespace {

RecentFrames::Entry at(double seconds) {
  auto frame = std::make_shared<Frame>();
  frame->mid_exposure_ns = std::llround(1e9 * seconds);
  RecentFrames::Entry entry;
  entry.frame = frame;
  entry.before = TrackingState(MotionState(ExposureTrajectory{}, frame->mid_exposure_ns - 1));
  return entry;
}

std::vector<std::int64_t> millisecondsOf(const std::vector<RecentFrames::Entry>& entries) {
  std::vector<std::int64_t> milliseconds;
  for (const RecentFrames::Entry& entry : entries) milliseconds.push_back(entry.frame->mid_exposure_ns / 1000000);
  return milliseconds;
}

TEST(RecentFrames, KeepsAllFromTheFirstBadlySeenOneOn) {
  RecentFrames recent;
  recent.add(at(1.0), false);
  recent.add(at(1.1), true);
  recent.add(at(1.2), false);
  recent.add(at(1.3), true);
  EXPECT_EQ(millisecondsOf(recent.takeAfter(0)), (std::vector<std::int64_t>{1100, 1200, 1300}));
  EXPECT_TRUE(recent.takeAfter(0).empty()) << "handed out twice";
}

TEST(RecentFrames, HandsOutThoseAfterTheReference) {
  RecentFrames recent;
  for (const double t : {1.0, 1.1, 1.2}) recent.add(at(t), true);
  EXPECT_EQ(millisecondsOf(recent.takeAfter(at(1.1).frame->mid_exposure_ns)), (std::vector<std::int64_t>{1200}));
}

TEST(RecentFrames, RemembersForASecond) {
  RecentFrames recent;
  for (int i = 0; i <= 30; ++i) recent.add(at(0.1 * i), true);
  const std::vector<std::int64_t> kept = millisecondsOf(recent.takeAfter(0));
  EXPECT_EQ(kept.front(), 2000);
  EXPECT_EQ(kept.size(), 11U);
}

TEST(RecentFrames, GoesOnRelativeToAnotherReference) {
  RecentFrames recent;
  recent.add(at(1.0), true);
  Vector6 step;
  step << 0.1, 0.2, 0.3, 0.01, 0.02, 0.03;
  recent.changeReference(SE3::exp(step));
  const auto entries = recent.takeAfter(0);
  ASSERT_EQ(entries.size(), 1U);
  EXPECT_LT((entries[0].before.T_reference_last().log() - step).norm(), 1e-12);
}

}  // namespace
}  // namespace mba_vo::recent_frames_test
