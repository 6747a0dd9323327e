#include "mba_vo/pose_graph/loop_verifier.h"

#include <gtest/gtest.h>

#include "mba_vo/relocalization/place_index.h"
#include "pose_graph/rendered_keyframes.h"

namespace mba_vo::loop_verifier_test {
namespace {

using test::KeyframeSetup;
using test::makeKeyframe;
using test::moved;

SE3 placeInRoom() { return test::roomSimulator().pose(1.0); }

/// Two visits of a place, the second of which sees it in another unit of length, and keyframes beside either.
struct Return {
  KeyframeSetup older, newer;
  SE3 T_old_new;  // in truth [m]
  SE3 start;      // two degrees off, and without the way
  std::vector<LoopWitness> witnesses;

  Return(const SE3& there, const SE3& back, double unit, const Vector6& old_velocity, const Vector6& new_velocity) {
    older = {1, 0.0, there, old_velocity, std::nullopt, 1.0};
    newer = {50, 10.0, back, new_velocity, std::nullopt, unit};
    T_old_new = there.inverse() * back;
    start = moved(SE3(T_old_new.rotation(), Eigen::Vector3d::Zero()), 0.0, 0.0, 0.0, 2.0);
    addWitness({2, 0.2, moved(there, 0.15, 0.0, 0.05, 3.0), {}, std::nullopt, 1.0}, older, true);
    addWitness({51, 10.2, moved(back, 0.12, 0.05, 0.0, -3.0), {}, std::nullopt, unit}, newer, false);
    addWitness({52, 10.4, moved(back, -0.15, 0.0, 0.05, 2.0), {}, std::nullopt, unit}, newer, false);
  }

  void addWitness(const KeyframeSetup& setup, const KeyframeSetup& beside, bool is_old) {
    const SE3 T = beside.T_world_camera.inverse() * setup.T_world_camera;
    witnesses.push_back({makeKeyframe(setup), SE3(T.rotation(), T.translation() / setup.unit), is_old});
  }

  LoopVerdict verify() const {
    return LoopVerifier(TrackerConfig()).verify(makeKeyframe(older), makeKeyframe(newer), {start}, witnesses);
  }
};

Vector6 turning(double right_px) {  // over the exposure
  Vector6 velocity = Vector6::Zero();
  velocity(4) = right_px / test::roomSimulator().camera().fx / test::kKeyframeExposure;
  velocity(0) = 0.1;
  return velocity;
}

void expectRight(const LoopVerdict& verdict, const Return& visit, const char* what) {
  ASSERT_TRUE(verdict.accepted()) << what << ": " << verdict.rejected_because;
  // A length in the newer one's unit is `unit` metres, the older one's unit is the metre.
  const SE3 error = visit.T_old_new.inverse() * verdict.S_old_new.rigid();
  EXPECT_LT(error.translation().norm(), 0.008) << what;  // 3 per mille of the depth
  EXPECT_LT(error.log().tail<3>().norm(), 0.003) << what;
  EXPECT_NEAR(std::log(verdict.S_old_new.scale()), std::log(visit.newer.unit), 0.005) << what;
  const double expected = std::sqrt(verdict.covariance.topLeftCorner<3, 3>().trace()) * visit.newer.unit;
  EXPECT_LT(error.translation().norm(), 4.0 * expected) << what;
  EXPECT_LT(expected, 0.02) << what;
}

TEST(LoopVerifier, FindsPoseAndScaleOfAReturn) {
  const SE3 there = placeInRoom();
  const Vector6 still = Vector6::Zero();
  for (const double unit : {1.0, 1.06, 0.93}) {
    const Return visit(there, moved(there, 0.25, 0.05, 0.15, 6.0), unit, still, still);
    expectRight(visit.verify(), visit, "sharp");
  }
  // Hardly any way between the two: only depths tell the scale.
  const Return close(there, moved(there, 0.01, 0.0, 0.0, 4.0), 1.05, still, still);
  expectRight(close.verify(), close, "from the same place");
}

TEST(LoopVerifier, FindsItThroughBlur) {
  const SE3 there = placeInRoom();
  const SE3 back = moved(there, 0.2, 0.05, 0.1, 4.0);
  const Return to_sharp(there, back, 1.04, Vector6::Zero(), turning(20.0));
  expectRight(to_sharp.verify(), to_sharp, "blurred to sharp");
  const Return both(there, back, 1.04, turning(12.0), turning(20.0));
  expectRight(both.verify(), both, "blurred to blurred");
}

TEST(LoopVerifier, OtherPlacesAreRejectedWithAReason) {
  const SE3 there = placeInRoom();
  const Vector6 still = Vector6::Zero();
  for (const double yaw : {60.0, 120.0, 180.0, 240.0}) {
    const Return visit(there, moved(there, 0.0, 0.0, 0.0, yaw), 1.0, still, still);
    EXPECT_FALSE(visit.verify().accepted()) << yaw;
    EXPECT_GT(visit.verify().rejected_because.size(), 10U);
  }
}

/// The pair fits, but keyframes beside it see something else.
TEST(LoopVerifier, WitnessesMayContradict) {
  const SE3 there = placeInRoom();
  Return visit(there, moved(there, 0.1, 0.0, 0.1, 5.0), 1.0, Vector6::Zero(), Vector6::Zero());
  EXPECT_TRUE(visit.verify().accepted());
  Return moved_witnesses = visit;
  for (LoopWitness& witness : moved_witnesses.witnesses) {
    witness.T_beside_keyframe = moved(witness.T_beside_keyframe, 0.06, 0.0, 0.0, 0.0);
  }
  EXPECT_NE(moved_witnesses.verify().rejected_because.find("contradicts"), std::string::npos)
      << moved_witnesses.verify().rejected_because;
  visit.witnesses.resize(1);
  EXPECT_NE(visit.verify().rejected_because.find("too few other keyframes"), std::string::npos)
      << visit.verify().rejected_because;
}

/// Rooms of one style: walls, shelves, desks and pictures, in other places. For every view of a room, those of all
/// other rooms that look most like it.
TEST(LoopVerifier, RoomsOfTheSameStyleAreNotTakenForEachOther) {
  constexpr int kRooms = 5, kViews = 6;
  PlaceIndex index;
  std::vector<ArchivedKeyframeConstPtr> keyframes;
  std::vector<std::vector<LoopWitness>> beside(kRooms * kViews);
  std::shared_ptr<const Simulator> room;
  for (int i = 0; i < kRooms * kViews; ++i) {
    if (i % kViews == 0) {
      const auto scene = std::make_shared<const Scene>(makeRoom(20 + i / kViews));
      room = std::make_shared<const Simulator>(test::roomConfig(), scene);
    }
    const SE3 T = moved(room->pose(1.0), 0.0, 0.0, 0.0, 60.0 * (i % kViews));
    const auto id = static_cast<KeyframeId>(i);
    keyframes.push_back(makeKeyframe({id, 1.0 * i, T, {}, std::nullopt, 1.0}, *room));
    for (const double step : {0.1, -0.1}) {
      const SE3 T_beside = moved(SE3(), step, 0.0, 0.05, 20.0 * step);
      beside[id].push_back({makeKeyframe({id + 100, 1.0 * i, T * T_beside, {}, std::nullopt, 1.0}, *room), T_beside});
    }
    index.add(id, PlaceDescriptor(keyframes.back()->restoreFrame()->pyramid));
  }
  const LoopVerifier verifier{TrackerConfig()};
  for (int i = 0; i < kRooms * kViews; ++i) {
    const auto elsewhere = [&](KeyframeId id) { return static_cast<int>(id) / kViews != i / kViews; };
    const PlaceDescriptor seen(keyframes[static_cast<std::size_t>(i)]->restoreFrame()->pyramid);
    for (const PlaceCandidate& alike : index.search(seen, 2, elsewhere)) {
      const double fx = test::roomSimulator().camera().fx;
      const SE3 start = moved(SE3(), 0.0, 0.0, 0.0, std::atan2(alike.shift_px.x(), fx) * 180.0 / M_PI);
      const LoopVerdict verdict = verifier.verify(keyframes[alike.keyframe], keyframes[static_cast<std::size_t>(i)],
                                                  {start}, beside[alike.keyframe]);
      EXPECT_FALSE(verdict.accepted()) << "views " << i << " and " << alike.keyframe;
    }
  }
}

}  // namespace
}  // namespace mba_vo::loop_verifier_test
