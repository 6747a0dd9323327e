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

}  // namespace
}  // namespace mba_vo::loop_closer_test
