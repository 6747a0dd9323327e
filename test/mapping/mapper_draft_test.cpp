#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "mapping/mapper_fixture.h"
#include "mba_vo/mapping/mapper.h"
#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo::test {
namespace {

constexpr double kClose = 5e-3;  // [m, rad]

double distance(const SE3& a, const SE3& b) { return (a.inverse() * b).log().norm(); }

/// Tracks the frames after those that made the map against the newest reference of the mapper.
class Follower {
 public:
  explicit Follower(Mapper& mapper) : mapper_(mapper), tracker_(config().tracker) {
    const Initialised initial = initialise(mapper);
    reference_ = initial.output.reference;
    motion_ = {reference_->hint->trajectory, reference_->hint->mid_exposure_ns};
    next_ = static_cast<std::size_t>(reference_->hint->frame_sequence - frames().front()->sequence) + 1;
  }

  /// The next frame.
  TrackedFrame track(const Reference& reference) const {
    const FrameConstPtr& frame = frames().at(next_);
    return tracker_.track(reference, frame, {motion_.priorAt(frame->mid_exposure_ns), 0.0});
  }

  /// Until there is another keyframe.
  MapperOutput toNextKeyframe() {
    while (next_ + 1 < frames().size()) {
      const auto tracked = std::make_shared<TrackedFrame>(track(*reference_));
      EXPECT_TRUE(tracked->tracked()) << tracked->reason;
      motion_.update(*tracked);
      ++next_;
      const MapperOutput output = mapper_.process(tracked);
      if (!output.keyframe) continue;
      const SE3& T_map_old = output.reference->T_map_keyframe.at(reference_->id.keyframe_id);
      motion_.changeReference(output.reference->T_map_reference.inverse() * T_map_old);
      reference_ = output.reference;
      return output;
    }
    ADD_FAILURE() << "no keyframe";
    return {};
  }

 private:
  Mapper& mapper_;
  Tracker tracker_;
  ReferenceConstPtr reference_;
  MotionState motion_;
  std::size_t next_ = 0;
};

TEST(MapperDraft, AKeyframeIsOfUseBeforeTheWindowIsOptimised) {
  std::vector<ReferenceConstPtr> drafts;
  Mapper mapper(config(), [&](const ReferenceConstPtr& draft) { drafts.push_back(draft); });
  Follower follower(mapper);
  for (std::size_t i = 1; i <= 3; ++i) {
    const MapperOutput output = follower.toNextKeyframe();
    ASSERT_EQ(drafts.size(), i) << "one for every keyframe, before process() returns";
    const Reference& draft = *drafts.back();
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
