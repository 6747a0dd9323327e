#include "mba_vo/odometry/frame_judge.h"

#include <gtest/gtest.h>

namespace mba_vo::frame_judge_test {
namespace {

constexpr double kInterval = 0.04;  // [s]

TrackedFrame tracked(double inlier_fraction, double pixel_error) {
  TrackedFrame frame;
  frame.status = TrackingStatus::kTracking;
  frame.inlier_fraction = inlier_fraction;
  frame.pixel_error = pixel_error;
  return frame;
}

TrackingStatus judged(FrameJudge& judge, TrackedFrame frame, bool lost, double seconds) {
  judge.judge(frame, lost, seconds);
  EXPECT_EQ(frame.reason.empty(), frame.status != TrackingStatus::kDegraded);
  return frame.status;
}

TEST(FrameJudge, APoorPoseAfterAGapIsNone) {
  FrameJudge judge{TrackerConfig()};
  EXPECT_EQ(judged(judge, tracked(0.5, 1.7), false, kInterval), TrackingStatus::kTracking);
  EXPECT_EQ(judged(judge, tracked(0.5, 1.7), false, 0.3), TrackingStatus::kLost);
  EXPECT_EQ(judged(judge, tracked(0.95, 0.2), false, 0.3), TrackingStatus::kDegraded);
  EXPECT_EQ(judged(judge, tracked(0.95, 0.2), false, kInterval), TrackingStatus::kTracking);
  EXPECT_EQ(judged(judge, tracked(0.5, 1.7), true, kInterval), TrackingStatus::kLost);
}

TEST(FrameJudge, LongIntervalsAreNoGapsIfTheyAreRegular) {
  FrameJudge judge{TrackerConfig()};
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(judged(judge, tracked(0.9, 0.2), false, 0.25), TrackingStatus::kTracking);
  }
  EXPECT_EQ(judged(judge, tracked(0.9, 0.2), false, 0.7), TrackingStatus::kDegraded);
}

TEST(FrameJudge, WhatIsKnownMuchWorseThanUsualIsDoubtful) {
  for (const double usual : {0.1, 0.4}) {
    FrameJudge judge{TrackerConfig()};
    TrackedFrame frame = tracked(0.95, 0.15);
    frame.expected_error = usual;
    for (int i = 0; i < 30; ++i) EXPECT_EQ(judged(judge, frame, false, kInterval), TrackingStatus::kTracking);
    frame.expected_error = 0.7;
    EXPECT_EQ(judged(judge, frame, false, kInterval),
              usual < 0.2 ? TrackingStatus::kDegraded : TrackingStatus::kTracking);
  }
}

TEST(FrameJudge, WhatFitsMuchWorseThanUsualIsDoubtful) {
  FrameJudge judge{TrackerConfig()};
  for (int i = 0; i < 30; ++i) judged(judge, tracked(0.95, 0.15), false, kInterval);
  EXPECT_EQ(judged(judge, tracked(0.9, 0.8), false, kInterval), TrackingStatus::kDegraded);
  EXPECT_EQ(judged(judge, tracked(0.9, 0.4), false, kInterval), TrackingStatus::kTracking);
  judge.reset();
  EXPECT_EQ(judged(judge, tracked(0.9, 0.8), false, kInterval), TrackingStatus::kTracking);
}

}  // namespace
}  // namespace mba_vo::frame_judge_test
