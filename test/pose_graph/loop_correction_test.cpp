#include "mba_vo/pose_graph/loop_correction.h"

#include <gtest/gtest.h>

#include "pose_graph/synthetic_walk.h"

namespace mba_vo::loop_correction_test {
namespace {

using test::positionError;

/// A walk whose odometry drifts, as the odometry tells of it: poses of scale 1, in a unit that grows on the way.
struct Walk {
  std::vector<Sim3> truth;
  std::vector<OdometryKeyframe> keyframes;
  std::vector<LoopTrial> loops;

  explicit Walk(double growth) {
    truth = test::syntheticWalk(80, 40, 1, 3).truth;
    SE3 T = truth.front().rigid();
    double unit = 1.0;
    units.push_back(unit);
    keyframes.push_back({0, T, std::nullopt, std::nullopt});
    for (std::size_t n = 1; n < truth.size(); ++n) {
      const SE3 step = truth[n - 1].rigid().inverse() * truth[n].rigid();
      Vector6 error;
      error << 0.001, -0.001, 0.0005, 0.0005, 0.0003, -0.0004;
      T = T * SE3(step.rotation(), step.translation() / unit) * SE3::exp(error);
      keyframes.push_back({static_cast<KeyframeId>(n), T, std::nullopt, std::nullopt});
      unit *= growth;
      units.push_back(unit);
    }
    for (const std::size_t n : {44U, 52U, 60U, 70U, 79U}) addLoop(n - 40, n);
  }

  std::vector<double> units;  // [m] at each keyframe

  void addLoop(std::size_t older, std::size_t newer) {
    LoopTrial loop;
    loop.older_map = loop.newer_map = 1;
    loop.older = static_cast<KeyframeId>(older);
    loop.newer = static_cast<KeyframeId>(newer);
    const SE3 T = truth[older].rigid().inverse() * truth[newer].rigid();
    loop.verdict.S_old_new = Sim3(SE3(T.rotation(), T.translation() / units[older]), units[newer] / units[older]);
    loop.verdict.covariance = 1e-6 * Matrix7::Identity();
    loops.push_back(loop);
  }

  CorrectedPoses correct() {
    std::vector<LoopTrial*> pointers;
    for (LoopTrial& loop : loops) pointers.push_back(&loop);
    return correctByLoops({{1, 2.0, keyframes}}, pointers);
  }

  /// After the best similarity [m].
  double error(const std::vector<Eigen::Vector3d>& positions) const {
    Eigen::Matrix3Xd estimate(3, positions.size()), right(3, positions.size());
    for (std::size_t n = 0; n < positions.size(); ++n) {
      estimate.col(static_cast<Eigen::Index>(n)) = positions[n];
      right.col(static_cast<Eigen::Index>(n)) = truth[n].translation();
    }
    const Eigen::Matrix4d S = Eigen::umeyama(estimate, right, true);
    const Eigen::Matrix3Xd off = (S.topLeftCorner<3, 3>() * estimate).colwise() + S.topRightCorner<3, 1>() - right;
    return std::sqrt(off.squaredNorm() / static_cast<double>(positions.size()));
  }
};

std::vector<Eigen::Vector3d> positionsOf(const std::vector<OdometryKeyframe>& keyframes) {
  std::vector<Eigen::Vector3d> positions;
  for (const OdometryKeyframe& keyframe : keyframes) positions.push_back(keyframe.T_map_keyframe.translation());
  return positions;
}

std::vector<Eigen::Vector3d> positionsOf(const CorrectedPoses& corrected) {
  std::vector<Eigen::Vector3d> positions;
  for (const auto& [id, S] : corrected) positions.push_back(S.translation());
  return positions;
}

TEST(LoopCorrection, TakesDriftOfPoseAndScaleAway) {
  Walk walk(1.002);
  const CorrectedPoses corrected = walk.correct();
  ASSERT_EQ(corrected.size(), walk.keyframes.size());
  EXPECT_LT(walk.error(positionsOf(corrected)), 0.35 * walk.error(positionsOf(walk.keyframes)));
  for (const LoopTrial& loop : walk.loops) EXPECT_TRUE(loop.verdict.accepted()) << loop.verdict.rejected_because;
  // The older ones adapt, the newest keeps its unit; the first stays where it is.
  EXPECT_NEAR(corrected.at(79).scale(), 1.0, 1e-12);
  EXPECT_NEAR(corrected.at(0).scale(), 1.0 / walk.units.back(), 0.02);
  EXPECT_LT((corrected.at(0).translation() - walk.keyframes.front().T_map_keyframe.translation()).norm(), 1e-12);
}

TEST(LoopCorrection, OneThatTheOthersContradictIsRejected) {
  Walk walk(1.002);
  const double right = walk.error(positionsOf(walk.correct()));
  walk.addLoop(10, 66);
  walk.loops.back().verdict.S_old_new = Sim3();
  EXPECT_LT(walk.error(positionsOf(walk.correct())), 1.05 * right);
  EXPECT_FALSE(walk.loops.back().verdict.accepted());
  EXPECT_LT(walk.loops.back().weight, 0.1);
}

/// Keyframes leave the window in any order, each attached to a newer one.
TEST(LoopCorrection, KeyframesMayHangOnAnyNewerOne) {
  Walk walk(1.002);
  for (std::size_t n = 0; n + 9 < walk.keyframes.size(); ++n) walk.keyframes[n].base = n % 3 == 0 ? n + 4 : n + 1;
  EXPECT_LT(walk.error(positionsOf(walk.correct())), 0.35 * walk.error(positionsOf(walk.keyframes)));
}

/// Keyframe 6 is made of the image of keyframe 2, by which a lost camera was found; a loop puts keyframe 5 elsewhere.
TEST(LoopCorrection, AfterALossTheMapHangsOnTheKeyframeByWhichTheCameraWasFound) {
  std::vector<OdometryKeyframe> keyframes;
  for (KeyframeId n = 0; n < 10; ++n) {
    const double x = n < 6 ? n : n - 4;
    keyframes.push_back({n, SE3(Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}), std::nullopt, std::nullopt});
  }
  keyframes[6].continues = 2;
  LoopTrial loop;
  loop.older = 0;
  loop.newer = 5;
  loop.verdict.S_old_new = Sim3(SE3(Eigen::Quaterniond::Identity(), {5.0, 0.1, 0.0}));
  loop.verdict.covariance = 1e-8 * Matrix7::Identity();
  const CorrectedPoses corrected = correctByLoops({{1, 2.0, keyframes}}, {&loop});
  EXPECT_NEAR(corrected.at(5).translation().y(), 0.1, 0.01);
  EXPECT_LT((corrected.at(6).translation() - corrected.at(2).translation()).norm(), 0.002);
  keyframes.resize(6);  // nothing that came after the loss says where the rest is
  const CorrectedPoses without = correctByLoops({{1, 2.0, keyframes}}, {&loop});
  const auto shape = [](const CorrectedPoses& poses, KeyframeId n) {  // the newest keyframe keeps its size
    return Eigen::Vector3d(poses.at(n).translation() / poses.at(5).translation().norm());
  };
  for (KeyframeId n = 1; n < 6; ++n) {
    EXPECT_LT((shape(corrected, n) - shape(without, n)).norm(), 1e-5) << "keyframe " << n;
  }
}

/// The second half of the walk is a map of its own, begun where it began, in a unit of 0.6 of the first; three
/// keyframes tell how the two stand to each other.
TEST(LoopCorrection, MapsThatHangTogetherAreInTheFrameOfTheFirstAndTheUnitOfTheLast) {
  constexpr std::size_t kSecond = 40;
  constexpr double kUnit = 0.6;
  Walk walk(1.0);
  std::vector<OdometryKeyframe> second(walk.keyframes.begin() + kSecond, walk.keyframes.end());
  const SE3 T_second_first = second.front().T_map_keyframe.inverse();
  for (OdometryKeyframe& keyframe : second) {
    const SE3 T = T_second_first * keyframe.T_map_keyframe;
    keyframe.T_map_keyframe = SE3(T.rotation(), T.translation() / kUnit);
  }
  walk.loops.resize(3);
  std::vector<LoopTrial*> joins;
  for (LoopTrial& loop : walk.loops) {
    loop.newer_map = 2;
    loop.verdict.S_old_new = Sim3(loop.verdict.S_old_new.rigid(), kUnit);
    joins.push_back(&loop);
  }
  const std::vector<OdometryKeyframe> first(walk.keyframes.begin(), walk.keyframes.begin() + kSecond);
  const CorrectedPoses corrected = correctByLoops({{1, 2.0, first}, {2, 2.0 / kUnit, second}}, joins);
  ASSERT_EQ(corrected.size(), walk.keyframes.size());
  EXPECT_LT(walk.error(positionsOf(corrected)), 1.1 * walk.error(positionsOf(walk.keyframes)));
  EXPECT_NEAR(corrected.at(79).scale(), 1.0, 1e-12);
  EXPECT_NEAR(corrected.at(0).scale(), 1.0 / kUnit, 0.02);
  EXPECT_LT((corrected.at(0).translation() - first.front().T_map_keyframe.translation()).norm(), 1e-12);
}

TEST(LoopCorrection, WithoutLoopsNothingMoves) {
  Walk walk(1.002);
  walk.loops.clear();
  EXPECT_TRUE(walk.correct().empty());
  walk.addLoop(3, 43);
  walk.loops.front().older = 4000;  // its pose has been forgotten
  EXPECT_TRUE(walk.correct().empty());
}

}  // namespace
}  // namespace mba_vo::loop_correction_test
