#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "mapping/follower.h"

namespace mba_vo::test {
namespace {

constexpr double kClose = 5e-3;  // [m, rad]

double distance(const SE3& a, const SE3& b) { return (a.inverse() * b).log().norm(); }

TEST(MapperDraft, AKeyframeIsOfUseBeforeTheWindowIsOptimised) {
  Mapper mapper(config());
  Follower follower(mapper);
  for (std::size_t i = 1; i <= 3; ++i) {
    const MapperOutput output = follower.toNextKeyframe();
    ASSERT_NE(follower.draft(), nullptr);
    const Reference& draft = *follower.draft();
    const Reference& refined = *output.reference;
    EXPECT_EQ(draft.id.keyframe_id, refined.id.keyframe_id);
    EXPECT_LT(draft.id.revision, refined.id.revision);
    EXPECT_GT(draft.points.size(), refined.points.size() / 2);
    EXPECT_LT(distance(draft.T_map_reference, refined.T_map_reference), kClose);
    EXPECT_GT(distance(draft.T_map_reference, refined.T_map_reference), 0.0) << "it has not been optimised yet";
    const TrackedFrame by_draft = follower.track(draft);
    EXPECT_EQ(by_draft.status, TrackingStatus::kTracking) << by_draft.reason;
    const SE3 by_refined = follower.track(refined).trajectory.T_reference_mid;
    EXPECT_LT(distance(by_draft.trajectory.T_reference_mid, by_refined), kClose);
  }
}

}  // namespace
}  // namespace mba_vo::test
