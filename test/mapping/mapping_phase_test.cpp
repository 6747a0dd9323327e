#include "mba_vo/mapping/mapping_phase.h"

#include <set>

#include <gtest/gtest.h>

#include "mapping/mapper_fixture.h"
#include "support/phase_tables.h"

namespace mba_vo::test::mapping_phase_test {
namespace {

using Phase = MappingPhase;
using Event = MappingEvent;

const std::set<Phase> kPhases = {Phase::kInitializing, Phase::kLocating, Phase::kMapping, Phase::kRefining,
                                 Phase::kLost};
const std::set<Event> kEvents = {Event::kMapBegins,    Event::kMapLoaded,       Event::kNotFound,
                                 Event::kKeyframe,     Event::kKeyframeRefined, Event::kFrameLost,
                                 Event::kFrameTracked, Event::kFoundAgain,      Event::kMapClosed};

TEST(MappingPhase, WhatIsNotInTheTableCannotHappen) { expectNothingElse(mappingTable(), kPhases, kEvents); }

TEST(MappingPhase, EveryPhaseCanBeReachedAndLeft) {
  EXPECT_EQ(reachableFrom(mappingTable(), Phase::kInitializing), kPhases);
  for (const Phase phase : kPhases) {
    EXPECT_EQ(nextPhase(mappingTable(), phase, Event::kMapClosed), Phase::kInitializing);
  }
}

TEST(MappingPhase, TheDocumentationShowsTheSameTable) {
  expectDocumented(mappingTable(), "| mapping | event → next phase |");
}

/// A frame that is seen turned away by 0.1 rad for each one before it, so that it becomes a keyframe.
MapperOutput turn(Mapper& mapper, const Initialised& initial, int frame) {
  Vector6 turn = Vector6::Zero();
  turn(4) = 0.1 * (frame + 1);
  const FrameConstPtr& image = frames().at(static_cast<std::size_t>(initial.frames_used + frame));
  return mapper.process(report(image, TrackingStatus::kTracking, initial.output.reference->id, SE3::exp(turn)));
}

TEST(MappingPhase, AMapIsBegunRefinedLostAndClosed) {
  Mapper mapper(config());
  EXPECT_EQ(mapper.phase(), Phase::kInitializing);
  const Initialised initial = initialise(mapper);
  ASSERT_NE(initial.output.reference, nullptr);
  EXPECT_EQ(mapper.phase(), Phase::kMapping);
  int used = 0;
  while (used < 5 && !turn(mapper, initial, used++).inserted) EXPECT_EQ(mapper.phase(), Phase::kMapping);
  EXPECT_EQ(mapper.phase(), Phase::kRefining);
  while (mapper.needsRefinement()) mapper.refine();
  EXPECT_EQ(mapper.phase(), Phase::kMapping);
  const FrameConstPtr unknown = shifted(elsewhere(frames().back()), 10.0);
  for (int i = 0; i < 3; ++i) {  // the first one may make a keyframe of what is left
    mapper.process(report(shifted(unknown, 0.04 * i), TrackingStatus::kLost));
  }
  EXPECT_EQ(mapper.phase(), Phase::kLost);
  EXPECT_FALSE(mapper.needsRefinement());
  mapper.reset();
  EXPECT_EQ(mapper.phase(), Phase::kInitializing);
}

TEST(MappingPhase, AResetMayComeWhileAKeyframeIsRefined) {
  Mapper mapper(config());
  const Initialised initial = initialise(mapper);
  ASSERT_NE(initial.output.reference, nullptr);
  int used = 0;
  while (used < 5 && !turn(mapper, initial, used++).inserted) EXPECT_EQ(mapper.phase(), Phase::kMapping);
  ASSERT_EQ(mapper.phase(), Phase::kRefining);
  mapper.reset();
  EXPECT_EQ(mapper.phase(), Phase::kInitializing);
  EXPECT_FALSE(mapper.needsRefinement());
}

}  // namespace
}  // namespace mba_vo::test::mapping_phase_test
