#include "mba_vo/pose_graph/loop_closer.h"

#include <gtest/gtest.h>

#include "pose_graph/rendered_keyframes.h"

namespace mba_vo::loop_closer_test {
namespace {

using test::KeyframeSetup;
using test::makeKeyframe;
using test::moved;

LoopConfig enabled() {
  LoopConfig config;
  config.close = true;
  return config;
}

/// A camera that turns away and comes back after half a minute, `off` from where it was by the odometry.
std::vector<KeyframeSetup> thereAndBack(const SE3& off) {
  const SE3 begin = test::roomSimulator().pose(1.0);
  std::vector<KeyframeSetup> keyframes;
  for (int i = 0; i < 12; ++i) {
    const double yaw = 14.0 * (i < 6 ? i : 11 - i);
    KeyframeSetup setup;
    setup.id = static_cast<KeyframeId>(i);
    setup.seconds = 3.0 * i;
    setup.T_world_camera = moved(begin, 0.03 * i, 0.01 * i, 0.02 * i, yaw);
    setup.T_map_camera = i < 6 ? setup.T_world_camera : off * setup.T_world_camera;
    keyframes.push_back(setup);
  }
  return keyframes;
}

LoopCloser run(const std::vector<KeyframeSetup>& keyframes, const LoopConfig& config = enabled()) {
  LoopCloser closer(config, TrackerConfig());
  for (const KeyframeSetup& setup : keyframes) closer.add(makeKeyframe(setup));
  return closer;
}

TEST(LoopCloser, AReturnClosesLoopsWhateverTheDrift) {
  const std::vector<KeyframeSetup> keyframes = thereAndBack(moved(SE3(), 0.1, -0.05, 0.08, 1.5));
  const LoopCloser closer = run(keyframes);
  int closed = 0;
  for (const LoopTrial& trial : closer.trials()) {
    if (!trial.verdict.accepted()) {
      EXPECT_GT(trial.verdict.rejected_because.size(), 10U);
      continue;
    }
    ++closed;
    const SE3 truth = keyframes[trial.older].T_world_camera.inverse() * keyframes[trial.newer].T_world_camera;
    EXPECT_LT((truth.inverse() * trial.verdict.S_old_new.rigid()).log().norm(), 0.012)
        << trial.older << " and " << trial.newer;
    EXPECT_NEAR(trial.verdict.S_old_new.scale(), 1.0, 0.006);
  }
  EXPECT_GE(closed, 3);
}

/// Odometry may drift, but not so far: it is another place that looks the same.
TEST(LoopCloser, WhatOdometryCannotHaveMissedIsRejected) {
  const LoopCloser closer = run(thereAndBack(moved(SE3(), 6.0, 0.0, 0.0, 0.0)));
  ASSERT_FALSE(closer.trials().empty());
  bool told = false;
  for (const LoopTrial& trial : closer.trials()) {
    if (trial.older >= 6 || trial.newer < 6) continue;  // what it sees twice on the way there, or back
    EXPECT_FALSE(trial.verdict.accepted());
    told = told || trial.verdict.rejected_because.find("odometry") != std::string::npos;
  }
  EXPECT_TRUE(told);
}

TEST(LoopCloser, KeepsWithinItsMemory) {
  LoopConfig config = enabled();
  config.max_megabytes = 1.0;
  const LoopCloser closer = run(thereAndBack(SE3()), config);
  EXPECT_LE(closer.bytes(), 1000000U);
  EXPECT_GE(closer.bytes(), 700000U);
  // 376x240: all told.
  const LoopCloser all = run(thereAndBack(SE3()));
  EXPECT_LE(all.bytes(), 12U * 150000U);
}

TEST(LoopCloser, AnotherMapHasNoPartInIt) {
  std::vector<KeyframeSetup> keyframes = thereAndBack(SE3());
  LoopCloser closer(enabled(), TrackerConfig());
  for (std::size_t i = 0; i < 6; ++i) closer.add(makeKeyframe(keyframes[i]));
  closer.forgetKeyframes();
  const std::size_t before = closer.trials().size();
  for (std::size_t i = 6; i < 12; ++i) closer.add(makeKeyframe(keyframes[i]));
  for (std::size_t i = before; i < closer.trials().size(); ++i) EXPECT_GE(closer.trials()[i].older, 6U);
  EXPECT_LE(closer.bytes(), 6U * 150000U);
}

/// The way back is another map: its frame is elsewhere, its unit of length is 0.7 m. Loops within a map are not wanted.
std::vector<KeyframeSetup> backInAnotherMap() {
  std::vector<KeyframeSetup> keyframes = thereAndBack(SE3());
  for (std::size_t i = 6; i < 12; ++i) {
    KeyframeSetup& setup = keyframes[i];
    setup.map = 2;
    setup.unit = 0.7;
    const SE3 T = moved(SE3(), 3.0, 1.0, -2.0, 70.0) * setup.T_world_camera;
    setup.T_map_camera = SE3(T.rotation(), T.translation() / setup.unit);
  }
  return keyframes;
}

void expectRight(const LoopTrial& trial, const std::vector<KeyframeSetup>& keyframes) {
  const SE3 truth = keyframes[trial.older].T_world_camera.inverse() * keyframes[trial.newer].T_world_camera;
  EXPECT_LT((truth.inverse() * trial.verdict.S_old_new.rigid()).log().norm(), 0.012)
      << trial.older << " and " << trial.newer;
  EXPECT_NEAR(std::log(trial.verdict.S_old_new.scale() / keyframes[trial.newer].unit), 0.0, 0.006);
}

TEST(LoopCloser, AMapIsJoinedToAnotherUntilItIsKnownWellHowTheyStand) {
  const std::vector<KeyframeSetup> keyframes = backInAnotherMap();
  const LoopCloser closer = run(keyframes, LoopConfig());
  int joins = 0;
  for (const LoopTrial& trial : closer.trials()) {
    EXPECT_EQ(trial.older_map, 1U) << "nothing is to be looked for within a map";
    EXPECT_EQ(trial.newer_map, 2U);
    if (!trial.verdict.accepted()) continue;
    ++joins;
    expectRight(trial, keyframes);
  }
  EXPECT_EQ(joins, 3);
  ASSERT_EQ(closer.usualDepths().size(), 2U);
  EXPECT_NEAR(closer.usualDepths().at(2) / closer.usualDepths().at(1), 1.0 / 0.7, 0.2);
}

TEST(LoopCloser, AKeyframeOfTheWindowIsLookedForWithThoseBesideIt) {
  const std::vector<KeyframeSetup> keyframes = backInAnotherMap();
  LoopCloser closer{LoopConfig(), TrackerConfig()};
  for (std::size_t i = 0; i < 6; ++i) closer.know(makeKeyframe(keyframes[i]));
  const std::size_t bytes = closer.bytes();
  std::vector<ArchivedKeyframeConstPtr> window;
  for (std::size_t i = 6; i < 12; ++i) window.push_back(makeKeyframe(keyframes[i]));
  for (const ArchivedKeyframeConstPtr& newest : window) closer.look(newest, window);
  int joins = 0;
  for (const LoopTrial& trial : closer.trials()) {
    if (!trial.verdict.accepted()) continue;
    ++joins;
    expectRight(trial, keyframes);
  }
  EXPECT_EQ(joins, 3);
  EXPECT_EQ(closer.bytes(), bytes) << "they are kept when they leave the window";
}

/// Where loops are closed, too, each keyframe is looked for in both: one found in its map says nothing of the others.
TEST(LoopCloser, ALoopDoesNotKeepMapsFromBeingJoined) {
  std::vector<KeyframeSetup> keyframes = backInAnotherMap();
  for (std::size_t i = 6; i < 12; ++i) {  // the way back once more
    KeyframeSetup again = keyframes[i];
    again.id += 6;
    again.seconds += 30.0;
    keyframes.push_back(again);
  }
  LoopCloser closer(enabled(), TrackerConfig());
  for (std::size_t i = 6; i < 12; ++i) closer.know(makeKeyframe(keyframes[i]));
  for (std::size_t i = 0; i < 6; ++i) closer.know(makeKeyframe(keyframes[i]));
  for (std::size_t i = 12; i < 18; ++i) closer.add(makeKeyframe(keyframes[i]));
  int loops = 0, joins = 0;
  for (const LoopTrial& trial : closer.trials()) {
    if (!trial.verdict.accepted()) continue;
    ++(trial.older_map == trial.newer_map ? loops : joins);
  }
  EXPECT_GE(loops, 4);
  EXPECT_EQ(joins, 3);
  const std::size_t before = closer.trials().size();
  closer.look(makeKeyframe(keyframes[17]), {});
  EXPECT_EQ(closer.trials().size(), before) << "that is for other maps only";
}

TEST(LoopCloser, AMapThatWasGivenUpIsJoinedToNothing) {
  const std::vector<KeyframeSetup> keyframes = backInAnotherMap();
  LoopCloser closer = run(keyframes, LoopConfig());
  closer.forget(2);
  for (const LoopTrial& trial : closer.trials()) EXPECT_FALSE(trial.verdict.accepted());
  EXPECT_EQ(closer.usualDepths().count(2), 0U);
  closer.forget(1);
  EXPECT_EQ(closer.bytes(), 0U);
}

}  // namespace
}  // namespace mba_vo::loop_closer_test
