#include "tracker_console.h"

#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros/console_lines.h"

namespace mba_vo::tracker_console_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class TrackerConsoleTest : public testing::Test {
 protected:
  /// A step after which the tracker is in this phase, with a frame of this status.
  void step(TrackingPhase phase, TrackingStatus status, const std::string& reason = "") {
    const auto tracked = std::make_shared<TrackedFrame>();
    tracked->status = status;
    tracked->reason = reason;
    TrackerStep step;
    step.kind = TrackerStep::Kind::kImage;
    step.phase = phase;
    step.message.tracked = tracked;
    console_.tell(step);
  }
  void track() { step(TrackingPhase::kTracking, TrackingStatus::kTracking); }
  void lose() { step(TrackingPhase::kLost, TrackingStatus::kLost, "too few points"); }
  /// What is said of the beginning is none of the test's.
  void beginMap() {
    step(TrackingPhase::kCatchingUp, TrackingStatus::kInitializing);
    track();
    said_.take();
  }

  TrackerConsole console_;
  ConsoleLines said_;
};

TEST_F(TrackerConsoleTest, AMapAndWhatComesBeforeItAreTold) {
  step(TrackingPhase::kNoMap, TrackingStatus::kInitializing, "no map yet");
  EXPECT_THAT(said_.take(), IsEmpty());
  step(TrackingPhase::kCatchingUp, TrackingStatus::kTracking);
  track();
  track();
  EXPECT_THAT(said_.take(),
              ElementsAre("there is a map: the images that waited for it are caught up with", "caught up"));
}

TEST_F(TrackerConsoleTest, LossAndReturnAreToldOnceEach) {
  beginMap();
  for (int i = 0; i < 3; ++i) lose();
  EXPECT_THAT(said_.take(), ElementsAre("WARN the camera is lost, and looked for: too few points"));
  step(TrackingPhase::kTracking, TrackingStatus::kDegraded, "poor");
  track();
  EXPECT_THAT(said_.take(), ElementsAre("the camera is found again"));
  lose();
  step(TrackingPhase::kRevising, TrackingStatus::kTracking);
  EXPECT_THAT(said_.take(),
              ElementsAre("WARN the camera is lost, and looked for: too few points", "the camera is found again"));
}

TEST_F(TrackerConsoleTest, ItIsNotFoundWhileItGoesBackNorWithoutAPose) {
  beginMap();
  lose();
  said_.take();
  step(TrackingPhase::kGoingBack, TrackingStatus::kTracking);
  step(TrackingPhase::kTracking, TrackingStatus::kLost, "nothing fits");
  EXPECT_THAT(said_.take(), IsEmpty());
  track();
  EXPECT_THAT(said_.take(), ElementsAre("the camera is found again"));
}

TEST_F(TrackerConsoleTest, ALossIsForgottenWithItsMap) {
  beginMap();
  lose();
  said_.take();
  step(TrackingPhase::kNoMap, TrackingStatus::kLost, "lost for a second");
  EXPECT_THAT(said_.take(), ElementsAre("WARN there is no map any more: lost for a second"));
  beginMap();
  track();
  EXPECT_THAT(said_.take(), IsEmpty());
  lose();
  step(TrackingPhase::kCatchingUp, TrackingStatus::kTracking);  // another map at once
  said_.take();
  track();
  EXPECT_THAT(said_.take(), ElementsAre("caught up"));
}

TEST_F(TrackerConsoleTest, ImagesThatAreLeftOutAreToldOncePerMap) {
  step(TrackingPhase::kCatchingUp, TrackingStatus::kInitializing);
  said_.take();
  TrackerStep late;
  late.kind = TrackerStep::Kind::kLate;
  late.phase = TrackingPhase::kCatchingUp;
  late.placed.emplace_back();
  for (int i = 0; i < 3; ++i) console_.tell(late);
  track();
  EXPECT_THAT(
      said_.take(),
      ElementsAre("WARN some of the images that wait are left out to catch up: the tracker does not keep up with "
                  "the camera",
                  "caught up"));
  // The pipeline says once that images come too fast: falling behind again and again is that.
  for (int i = 0; i < 3; ++i) {
    console_.tell(late);
    track();
  }
  EXPECT_THAT(said_.take(), IsEmpty());
}

}  // namespace
}  // namespace mba_vo::tracker_console_test
