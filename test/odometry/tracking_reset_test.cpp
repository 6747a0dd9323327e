#include <cstdint>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/odometry/tracking_loop.h"
#include "odometry/outcome.h"
#include "odometry/tracking_loop_fixture.h"

namespace mba_vo::test::tracking_reset_test {
namespace {

// After a reset, whatever went before, everything must be as if it had never happened: to the last bit.

/// The next keyframe of the map that `makeReference(1, 0, 0, SE3())` began.
ReferenceConstPtr keyframeAt(int index) {
  auto reference = makeReference(1, 1, index, truth(0, index));
  reference->T_map_keyframe[0] = SE3();
  return reference;
}

/// A tracker's whole life in short: no map, catching up, leaving a keyframe's view, tracking once more, unknown
/// exposures, an image that shows nothing.
std::vector<Outcome> live(TrackingLoop& loop) {
  std::vector<Outcome> outcomes;
  const auto note = [&](const TrackedFrameConstPtr& tracked) {
    if (!tracked) return;
    outcomes.push_back(outcomeOf(*tracked, loop.T_odom_camera()));
    outcomes.back().text += " " + std::to_string(loop.waitingFrames()) + " wait, " + toString(loop.phase());
  };
  for (int i = 0; i <= 3; ++i) note(loop.process(frame(i)));
  for (const auto& late : adopt(loop, makeReference(1, 0, 0, SE3(), 1))) note(late);
  for (int i = 4; i <= 9; ++i) note(loop.process(frame(i)));
  for (const auto& late : adopt(loop, keyframeAt(6))) note(late);
  for (int i = 10; i <= 12; ++i) note(loop.process(makeFrame(view(i), std::nullopt)));
  note(loop.process(makeFrame(cv::Mat1f(240, 376, 90.0F), view(13).mid_exposure_ns, 0.02)));
  note(loop.process(frame(14)));
  return outcomes;
}

void trackFrom(TrackingLoop& loop, int first, int last) {
  adopt(loop, makeReference(1, 0, 0, someCorrection(), 0));
  for (int i = first; i <= last; ++i) loop.process(frame(i));
}

struct LoopState {
  const char* name;
  std::function<void(TrackingLoop&)> reach;
};

std::ostream& operator<<(std::ostream& out, const LoopState& state) { return out << state.name; }

class ResetOfTheTracker : public testing::TestWithParam<LoopState> {};

TEST_P(ResetOfTheTracker, LeavesNothingBehind) {
  static const std::vector<Outcome> fresh = [] {
    TrackingLoop loop(demanding());
    return live(loop);
  }();
  TrackingLoop loop(demanding());
  GetParam().reach(loop);
  loop.reset();
  EXPECT_EQ(loop.reference(), nullptr);
  EXPECT_EQ(loop.waitingFrames(), 0U);
  EXPECT_EQ(loop.trackWaiting(), nullptr);
  expectSame(live(loop), fresh);
}

const LoopState kLoopStates[] = {
    {"Initializing",
     [](TrackingLoop& loop) {
       for (int i = 0; i < 4; ++i) EXPECT_EQ(loop.process(frame(i))->status, TrackingStatus::kInitializing);
     }},
    {"InitializingAfterAMapWasGivenUp",
     [](TrackingLoop& loop) {
       trackFrom(loop, 1, 3);
       EXPECT_TRUE(loop.take(closed(*loop.reference(), "given up")));
       EXPECT_EQ(loop.process(frame(4))->status, TrackingStatus::kInitializing);
     }},
    {"CatchingUp",
     [](TrackingLoop& loop) {
       for (int i = 0; i < 6; ++i) loop.process(frame(i));
       loop.take(makeReference(1, 0, 0, someCorrection(), 1));
       EXPECT_NE(loop.trackWaiting(), nullptr);
       EXPECT_EQ(loop.phase(), TrackingPhase::kCatchingUp);
     }},
    {"HeldForAKeyframe",
     [](TrackingLoop& loop) {
       for (int i = 0; i <= 10; ++i) loop.process(frame(i));
       loop.take(makeReference(1, 0, 0, SE3(), 0));
       while (loop.trackWaiting()) {
       }
       EXPECT_GT(loop.waitingFrames(), 0U);
     }},
    {"Tracking",
     [](TrackingLoop& loop) {
       trackFrom(loop, 1, 3);
       EXPECT_EQ(loop.process(frame(4))->status, TrackingStatus::kTracking);
     }},
    {"TrackingProvisionally",
     [](TrackingLoop& loop) {
       trackFrom(loop, 1, 8);
       EXPECT_TRUE(loop.process(frame(9))->provisional);
     }},
    {"TrackingWithAnExposureThatWasLearnt",
     [](TrackingLoop& loop) {
       adopt(loop, makeReference(1, 0, 0, SE3(), 0));
       TrackedFrameConstPtr tracked;
       for (int i = 1; i < kCount; ++i) {
         if (i == 8) adopt(loop, keyframeAt(7));
         tracked = loop.process(makeFrame(view(i), std::nullopt));
       }
       EXPECT_TRUE(tracked->exposure_estimate.used);
     }},
    {"Degraded",
     [](TrackingLoop& loop) {
       auto reference = std::make_shared<Reference>(*makeReference(1, 0, 0, SE3(), 0));
       reference->doubt = "the map contradicts itself";
       adopt(loop, reference);
       EXPECT_EQ(loop.process(frame(1))->status, TrackingStatus::kDegraded);
     }},
    {"Lost",
     [](TrackingLoop& loop) {
       trackFrom(loop, 1, 3);
       for (int i = 0; i < 4; ++i) EXPECT_EQ(loop.process(elsewhere(0.1 * i))->status, TrackingStatus::kLost);
     }},
    {"LostForGood",
     [](TrackingLoop& loop) {
       trackFrom(loop, 1, 3);
       for (int i = 0; i < 20; ++i) loop.process(elsewhere(0.1 * i));
       EXPECT_TRUE(loop.take(closed(*loop.reference(), "lost for too long")));
       loop.process(elsewhere(2.0));
       EXPECT_EQ(loop.phase(), TrackingPhase::kNoMap);
     }},
    {"Covered",
     [](TrackingLoop& loop) {
       trackFrom(loop, 1, 3);
       EXPECT_TRUE(loop.process(later(cv::Mat1f(240, 376, 90.0F), 0.1))->blind);
     }},
    {"Frozen",
     [](TrackingLoop& loop) {
       trackFrom(loop, 1, 3);
       const TrackedFrameConstPtr tracked = loop.process(later(toFloat(view(3).blurred), 0.5), Backlog::kNothing, true);
       EXPECT_TRUE(tracked->blind);
     }},
    {"TrackingOnceMore",
     [](TrackingLoop& loop) {
       trackFrom(loop, 1, 9);
       auto next = makeReference(1, 1, 5, someCorrection() * truth(0, 5));
       next->T_map_keyframe[0] = someCorrection();
       ASSERT_TRUE(loop.take(next));
       EXPECT_NE(loop.trackWaiting(), nullptr);
       EXPECT_EQ(loop.phase(), TrackingPhase::kRevising);
       loop.process(frame(10));  // ahead of those that wait, or instead of them
     }},
};

std::string nameOf(const testing::TestParamInfo<LoopState>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(InEveryState, ResetOfTheTracker, testing::ValuesIn(kLoopStates), nameOf);

}  // namespace
}  // namespace mba_vo::test::tracking_reset_test
