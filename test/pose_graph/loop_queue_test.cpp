#include "mba_vo/pose_graph/loop_queue.h"

#include <gtest/gtest.h>

#include "pose_graph/rendered_keyframes.h"

namespace mba_vo::loop_queue_test {
namespace {

constexpr std::size_t kAny = 1000;

LoopConfig enabled() {
  LoopConfig config;
  config.close = true;
  return config;
}

/// A camera that turns away and back again.
const std::vector<ArchivedKeyframeConstPtr>& thereAndBack() {
  static const std::vector<ArchivedKeyframeConstPtr> keyframes = [] {
    std::vector<ArchivedKeyframeConstPtr> made;
    for (int i = 0; i < 8; ++i) {
      test::KeyframeSetup setup;
      setup.id = static_cast<KeyframeId>(i);
      setup.seconds = 3.0 * i;
      setup.T_world_camera =
          test::moved(test::roomSimulator().pose(1.0), 0.03 * i, 0.0, 0.02 * i, 14.0 * (i < 4 ? i : 7 - i));
      made.push_back(test::makeKeyframe(setup));
    }
    return made;
  }();
  return keyframes;
}

void expectSame(const std::vector<LoopTrial>& trials, const std::vector<LoopTrial>& expected) {
  ASSERT_EQ(trials.size(), expected.size());
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_EQ(trials[i].older, expected[i].older);
    EXPECT_EQ(trials[i].newer, expected[i].newer);
    EXPECT_EQ(trials[i].verdict.rejected_because, expected[i].verdict.rejected_because);
    EXPECT_EQ(trials[i].verdict.S_old_new.increment(), expected[i].verdict.S_old_new.increment());
  }
}

TEST(LoopQueue, WhatComesOutDoesNotDependOnTime) {
  LoopCloser at_once(enabled(), TrackerConfig());
  for (const ArchivedKeyframeConstPtr& keyframe : thereAndBack()) at_once.add(keyframe);
  LoopQueue queue(enabled(), TrackerConfig(), kAny);
  for (const ArchivedKeyframeConstPtr& keyframe : thereAndBack()) queue.add(keyframe);
  expectSame(queue.settled().trials(), at_once.trials());
  LoopQueue waited_for(enabled(), TrackerConfig(), kAny);
  for (const ArchivedKeyframeConstPtr& keyframe : thereAndBack()) {
    waited_for.add(keyframe);
    waited_for.settled();
  }
  expectSame(waited_for.settled().trials(), at_once.trials());
}

TEST(LoopQueue, CountsWhatBecameOfKeyframes) {
  LoopQueue queue(enabled(), TrackerConfig(), kAny);
  EXPECT_EQ(queue.counts().compared, 0U);
  for (const ArchivedKeyframeConstPtr& keyframe : thereAndBack()) queue.add(keyframe);
  EXPECT_GT(queue.counts().waiting, 0U);
  const std::vector<LoopTrial>& trials = queue.settled().trials();
  const LoopCounts counts = queue.counts();
  EXPECT_EQ(counts.waiting, 0U);
  EXPECT_EQ(counts.left_out, 0U);
  EXPECT_EQ(counts.compared, trials.size());
  EXPECT_GE(counts.closed, 2U);
  EXPECT_NE(counts.last.find("keyframes "), std::string::npos) << counts.last;
}

TEST(LoopQueue, IsBounded) {
  LoopQueue queue(enabled(), TrackerConfig(), 2);
  for (const ArchivedKeyframeConstPtr& keyframe : thereAndBack()) queue.add(keyframe);
  EXPECT_GT(queue.counts().left_out, 0U);
  EXPECT_LE(queue.counts().waiting, thereAndBack().size() - queue.counts().left_out);
  queue.settled();
}

TEST(LoopQueue, MayGoWhileItWorks) {
  LoopQueue queue(enabled(), TrackerConfig(), kAny);
  for (const ArchivedKeyframeConstPtr& keyframe : thereAndBack()) queue.add(keyframe);
  queue.forgetKeyframes();
}

TEST(LoopQueue, AMapThatIsLeftIsLookedForInThoseThatWereLeftBefore) {
  std::vector<ArchivedKeyframe> first, second;
  for (std::size_t i = 0; i < 4; ++i) first.push_back(*thereAndBack()[i]);
  for (std::size_t i = 4; i < 8; ++i) {
    second.push_back(*thereAndBack()[i]);
    second.back().reference.id.map_id = 2;
  }
  LoopQueue queue(LoopConfig(), TrackerConfig(), kAny);
  queue.leave(first);
  EXPECT_TRUE(queue.settled().trials().empty());
  queue.leave(second);
  queue.settled();
  const std::vector<LoopTrial> joins = queue.found().loops;
  EXPECT_GE(joins.size(), 2U);
  for (const LoopTrial& join : joins) {
    EXPECT_EQ(join.older_map, 1U);
    EXPECT_EQ(join.newer_map, 2U);
  }
  EXPECT_EQ(queue.found().usual_depths.size(), 2U);
  queue.forget(2);
  EXPECT_TRUE(queue.found().loops.empty());
  queue.settled();
  EXPECT_TRUE(queue.found().loops.empty());
}

TEST(LoopQueue, AnotherMapBeginsWithoutKeyframes) {
  LoopQueue queue(enabled(), TrackerConfig(), kAny);
  for (std::size_t i = 0; i < 4; ++i) queue.add(thereAndBack()[i]);
  queue.forgetKeyframes();
  const std::size_t before = queue.settled().trials().size();
  queue.add(thereAndBack()[7]);
  EXPECT_EQ(queue.settled().trials().size(), before);
}

}  // namespace
}  // namespace mba_vo::loop_queue_test
