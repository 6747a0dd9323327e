#include "mba_vo/odometry/tracking_phase.h"

#include <set>

#include <gtest/gtest.h>

#include "support/phase_tables.h"

namespace mba_vo::test::tracking_phase_test {
namespace {

using Phase = TrackingPhase;
using Event = TrackingEvent;

const std::set<Phase> kPhases = {Phase::kNoMap,    Phase::kCatchingUp, Phase::kTracking,
                                 Phase::kRevising, Phase::kGoingBack,  Phase::kLost};
const std::set<Event> kEvents = {Event::kMapBegins, Event::kMapClosed,    Event::kKeyframe,     Event::kRevise,
                                 Event::kGoBack,    Event::kImageWaits,   Event::kNothingWaits, Event::kFallBehind,
                                 Event::kGoOn,      Event::kFrameTracked, Event::kFrameLost,    Event::kReset};

TEST(TrackingPhase, WhatIsNotInTheTableCannotHappen) { expectNothingElse(trackingTable(), kPhases, kEvents); }

TEST(TrackingPhase, EveryPhaseCanBeReachedAndLeft) {
  EXPECT_EQ(reachableFrom(trackingTable(), Phase::kNoMap), kPhases);
  for (const Phase phase : kPhases) {
    EXPECT_EQ(nextPhase(trackingTable(), phase, Event::kReset), Phase::kNoMap);
    if (phase == Phase::kNoMap) continue;
    EXPECT_EQ(nextPhase(trackingTable(), phase, Event::kMapClosed), Phase::kNoMap);
  }
}

TEST(TrackingPhase, TheDocumentationShowsTheSameTable) {
  expectDocumented(trackingTable(), "| tracking | event → next phase |");
}

}  // namespace
}  // namespace mba_vo::test::tracking_phase_test
