#include "mba_vo/trajectory/trajectory_store.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::trajectory_store_test {
namespace {

TrackedFrame trackedAt(std::uint64_t sequence, std::int64_t mid_ns, MapId map, KeyframeId keyframe,
                       const SE3& T_keyframe_mid) {
  auto frame = std::make_shared<Frame>();
  frame->sequence = sequence;
  frame->stamp_ns = mid_ns - 5;
  frame->mid_exposure_ns = mid_ns;
  TrackedFrame tracked;
  tracked.frame = frame;
  tracked.status = TrackingStatus::kTracking;
  tracked.reference = {map, keyframe, 0};
  tracked.trajectory.T_reference_mid = T_keyframe_mid;
  return tracked;
}

constexpr double kSinglePrecision = 1e-6;  // as poses relative to keyframes are stored

double distance(const SE3& a, const SE3& b) { return (a.inverse() * b).log().norm(); }

TEST(TrajectoryStore, AKeyframeHasItsOwnPose) {
  test::Random random(2);
  const SE3 T_map_keyframe = random.pose(1.0, 1.0);
  TrackedFrame tracked = trackedAt(7, 700, 1, 3, random.pose(0.2, 0.2));
  tracked.trajectory.velocity = random.tangent(1.0, 1.0);
  tracked.trajectory.exposure = 0.02;
  TrajectoryStore store;
  store.setKeyframePose(1, 3, SE3());
  store.setKeyframePose(1, 4, T_map_keyframe);
  store.addFrame(tracked);
  store.makeKeyframe(tracked, 1, 4);
  store.addFrame(tracked);  // tracked again
  const auto entries = store.entries();
  ASSERT_EQ(entries.size(), 1U);
  EXPECT_LT(distance(entries[0].trajectory.T_reference_mid, T_map_keyframe), 1e-12);
  EXPECT_LT((entries[0].trajectory.velocity - tracked.trajectory.velocity).norm(), 1e-6);
  EXPECT_EQ(entries[0].trajectory.exposure, 0.02);
}

TEST(TrajectoryStore, KnowsWhichPosesWereDoubtful) {
  TrajectoryStore store;
  store.setKeyframePose(1, 3, SE3());
  TrackedFrame tracked = trackedAt(7, 700, 1, 3, SE3());
  tracked.status = TrackingStatus::kDegraded;
  store.addFrame(tracked);
  EXPECT_TRUE(store.entries().at(0).degraded);
  tracked.status = TrackingStatus::kTracking;
  store.addFrame(tracked);  // seen better the second time
  EXPECT_FALSE(store.entries().at(0).degraded);
}

TEST(TrajectoryStore, ComposesFramesWithTheNewestPoseOfTheirKeyframe) {
  test::Random random(1);
  const SE3 old_pose = random.pose(1.0, 1.0);
  const SE3 new_pose = random.pose(1.0, 1.0);
  const SE3 T_keyframe_mid = random.pose(0.2, 0.2);
  TrackedFrame tracked = trackedAt(7, 700, 1, 3, T_keyframe_mid);
  tracked.trajectory.velocity = random.tangent(1.0, 1.0);
  tracked.trajectory.exposure = 0.02;

  TrajectoryStore store;
  store.setKeyframePose(1, 3, old_pose);
  store.addFrame(tracked);
  EXPECT_LT(distance(store.entries().at(0).trajectory.T_reference_mid, old_pose * T_keyframe_mid), kSinglePrecision);

  store.setKeyframePose(1, 3, new_pose);
  EXPECT_LT(distance(store.T_map_keyframe(1, 3), new_pose), 1e-12);
  const TrajectoryEntry entry = store.entries().at(0);
  EXPECT_LT(distance(entry.trajectory.T_reference_mid, new_pose * T_keyframe_mid), kSinglePrecision);
  EXPECT_LT(distance(entry.trajectory.start(), new_pose * tracked.trajectory.start()), 1e-8);
  EXPECT_LT(distance(entry.trajectory.end(), new_pose * tracked.trajectory.end()), 1e-8);
  EXPECT_EQ(entry.frame_sequence, 7U);
  EXPECT_EQ(entry.stamp_ns, 695);
  EXPECT_EQ(entry.mid_exposure_ns, 700);
  EXPECT_EQ(entry.map_id, 1U);
}

TEST(TrajectoryStore, SortsByTimeWhateverTheOrderOfArrival) {
  TrajectoryStore store;
  store.setKeyframePose(1, 0, SE3());
  // Frames tracked backwards in time, and a sequence number that was reset.
  const std::int64_t times[] = {500, 300, 900, 100};
  const std::uint64_t sequences[] = {5, 3, 0, 1};
  for (int i = 0; i < 4; ++i) store.addFrame(trackedAt(sequences[i], times[i], 1, 0, SE3()));
  const auto entries = store.entries();
  ASSERT_EQ(entries.size(), 4U);
  for (std::size_t i = 1; i < entries.size(); ++i)
    EXPECT_LT(entries[i - 1].mid_exposure_ns, entries[i].mid_exposure_ns);
  EXPECT_EQ(entries.back().frame_sequence, 0U);
}

TEST(TrajectoryStore, ASecondResultOfAFrameReplacesTheFirst) {
  test::Random random(2);
  const SE3 first = random.pose(1.0, 1.0);
  const SE3 second = random.pose(1.0, 1.0);
  TrajectoryStore store;
  store.setKeyframePose(1, 0, SE3());
  store.setKeyframePose(1, 1, random.pose(1.0, 1.0));
  store.addFrame(trackedAt(4, 400, 1, 1, first));
  store.addFrame(trackedAt(4, 400, 1, 0, second));
  const auto entries = store.entries();
  ASSERT_EQ(entries.size(), 1U);
  EXPECT_LT(distance(entries[0].trajectory.T_reference_mid, second), kSinglePrecision);
}

TEST(TrajectoryStore, KeepsMapsApart) {
  test::Random random(3);
  const SE3 in_first = random.pose(1.0, 1.0);
  const SE3 in_second = random.pose(1.0, 1.0);
  TrajectoryStore store;
  store.setKeyframePose(1, 0, in_first);
  store.setKeyframePose(2, 0, in_second);  // the same keyframe number
  store.addFrame(trackedAt(1, 100, 1, 0, SE3()));
  store.addFrame(trackedAt(2, 200, 2, 0, SE3()));
  const auto entries = store.entries();
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].map_id, 1U);
  EXPECT_EQ(entries[1].map_id, 2U);
  EXPECT_LT(distance(entries[0].trajectory.T_reference_mid, in_first), 1e-12);
  EXPECT_LT(distance(entries[1].trajectory.T_reference_mid, in_second), 1e-12);
}

TEST(TrajectoryStore, MapsOfAClockThatBeganAnewDoNotInterleave) {
  TrajectoryStore store;
  for (const MapId map : {1U, 2U}) {
    store.setKeyframePose(map, 0, SE3());
    for (std::uint64_t i = 0; i < 3; ++i) store.addFrame(trackedAt(10 * map + i, 100 * (i + 1), map, 0, SE3()));
  }
  std::vector<std::uint64_t> frames;
  for (const TrajectoryEntry& entry : store.entries()) frames.push_back(entry.frame_sequence);
  EXPECT_EQ(frames, (std::vector<std::uint64_t>{10, 11, 12, 20, 21, 22}));
}

TEST(TrajectoryStore, ForgetsTheLastPosesOfAMap) {
  TrajectoryStore store;
  for (KeyframeId id = 0; id < 3; ++id) store.setKeyframePose(1, id, SE3());
  store.setKeyframePose(2, 2, SE3());
  store.addFrame(trackedAt(1, 100, 1, 0, SE3()));
  store.addFrame(trackedAt(2, 200, 1, 1, SE3()));
  store.addFrame(trackedAt(3, 300, 1, 2, SE3()));
  store.addFrame(trackedAt(4, 400, 2, 2, SE3()));
  store.forget(1, 1);
  const auto entries = store.entries();
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].frame_sequence, 1U);
  EXPECT_EQ(entries[1].frame_sequence, 4U) << "another map";
}

TEST(TrajectoryStore, AttachedKeyframesFollowTheNewerOnes) {
  test::Random random(4);
  const SE3 motion = random.pose(0.3, 0.3);
  std::vector<SE3> first;
  TrajectoryStore store;
  for (KeyframeId id = 0; id < 4; ++id) {
    first.push_back(random.pose(1.0, 1.0));
    store.setKeyframePose(1, id, first.back());
    store.addFrame(trackedAt(id, 100 * (id + 1), 1, id, SE3()));
  }
  store.attachKeyframe(1, 1, 2);  // out of turn
  store.attachKeyframe(1, 0, 1);
  store.attachKeyframe(1, 2, 3);
  for (KeyframeId id = 0; id < 4; ++id) EXPECT_LT(distance(store.T_map_keyframe(1, id), first[id]), 1e-12);

  store.setKeyframePose(1, 3, motion * first[3]);
  const auto entries = store.entries();
  ASSERT_EQ(entries.size(), 4U);
  for (KeyframeId id = 0; id < 4; ++id) {
    EXPECT_LT(distance(store.T_map_keyframe(1, id), motion * first[id]), 1e-12);
    EXPECT_LT(distance(entries[id].trajectory.T_reference_mid, motion * first[id]), 1e-12);
  }
  EXPECT_THROW(store.attachKeyframe(1, 3, 3), std::invalid_argument);
  EXPECT_THROW(store.attachKeyframe(1, 3, 4), std::out_of_range);
}

TEST(TrajectoryStore, DoesNotInventPosesOfUnknownKeyframes) {
  TrajectoryStore store;
  EXPECT_TRUE(store.entries().empty());
  store.setKeyframePose(1, 0, SE3());
  EXPECT_THROW(store.T_map_keyframe(1, 1), std::out_of_range);
  EXPECT_THROW(store.T_map_keyframe(2, 0), std::out_of_range);
}

TEST(TrajectoryStore, TellsWhereTheKeyframesOfAMapAre) {
  test::Random random(5);
  const SE3 T_a = random.pose(1.0, 1.0), T_b = random.pose(1.0, 1.0), T_b_later = random.pose(1.0, 1.0);
  TrajectoryStore store;
  store.setKeyframePose(1, 3, T_a);
  store.setKeyframePose(1, 8, T_b);
  store.setKeyframePose(2, 1, SE3());
  store.attachKeyframe(1, 3, 8);
  store.setKeyframePose(1, 8, T_b_later);
  const auto places = store.keyframes(1);
  ASSERT_EQ(places.size(), 2U);
  EXPECT_EQ(places[0].keyframe, 3U);
  EXPECT_EQ(places[0].base, 8U);
  EXPECT_LT(distance(places[0].T_map_keyframe, T_b_later * T_b.inverse() * T_a), 1e-9);
  EXPECT_EQ(places[1].keyframe, 8U);
  EXPECT_FALSE(places[1].base);
  EXPECT_FALSE(places[1].continues);
  store.continueFrom(1, 8, 3);
  EXPECT_EQ(store.keyframes(1)[1].continues, 3U);
  EXPECT_THROW(store.continueFrom(1, 3, 8), std::invalid_argument);
  EXPECT_THROW(store.continueFrom(1, 8, 2), std::out_of_range);
  EXPECT_THROW(store.continueFrom(1, 9, 3), std::out_of_range);
}

/// Frames follow their keyframe, in its unit of length.
TEST(TrajectoryStore, CorrectedKeyframesTakeTheirFramesAlong) {
  test::Random random(6);
  TrajectoryStore store;
  store.setKeyframePose(1, 3, random.pose(1.0, 1.0));
  store.setKeyframePose(1, 4, random.pose(1.0, 1.0));
  TrackedFrame tracked = trackedAt(7, 700, 1, 3, random.pose(0.3, 0.3));
  tracked.trajectory.velocity = random.tangent(1.0, 1.0);
  store.addFrame(tracked);
  store.addFrame(trackedAt(8, 800, 1, 4, random.pose(0.3, 0.3)));
  const Sim3 S(random.pose(1.0, 1.0), 1.2);
  const auto as_is = store.entries();
  const auto entries = store.entries({{{1, 3}, S}});
  ASSERT_EQ(entries.size(), 2U);
  const SE3& T = entries[0].trajectory.T_reference_mid;
  const SE3& T_keyframe_mid = tracked.trajectory.T_reference_mid;
  EXPECT_LT((T.translation() - S * T_keyframe_mid.translation()).norm(), kSinglePrecision);
  EXPECT_LT((T.rotationMatrix() - S.rotationMatrix() * T_keyframe_mid.rotationMatrix()).norm(), kSinglePrecision);
  EXPECT_LT((entries[0].trajectory.velocity.head<3>() - 1.2 * tracked.trajectory.velocity.head<3>()).norm(), 1e-6);
  EXPECT_LT((entries[0].trajectory.velocity.tail<3>() - tracked.trajectory.velocity.tail<3>()).norm(), 1e-6);
  EXPECT_LT(distance(entries[1].trajectory.T_reference_mid, as_is[1].trajectory.T_reference_mid), 1e-12);
}

}  // namespace
}  // namespace mba_vo::trajectory_store_test
