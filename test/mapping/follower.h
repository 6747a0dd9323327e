#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "mapping/mapper_fixture.h"
#include "mba_vo/mapping/mapper.h"
#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo::test {

/// Tracks the frames after those that made the map against the newest reference of the mapper.
class Follower {
 public:
  explicit Follower(Mapper& mapper, const std::vector<FrameConstPtr>& images = frames())
      : mapper_(mapper), images_(images), tracker_(config().tracker) {
    begin(initialise(mapper, images).output.reference);
    adopt(mapper.currentReference());
  }

  /// Goes on from a reference of another map, or one by which the camera was found.
  void begin(const ReferenceConstPtr& reference) {
    reference_ = reference;
    motion_ = {reference_->hint->trajectory, reference_->hint->mid_exposure_ns};
    next_ = static_cast<std::size_t>(reference_->hint->frame_sequence - images_.front()->sequence) + 1;
  }

  /// The next frame.
  TrackedFrame track(const Reference& reference) const {
    const FrameConstPtr& frame = images_.at(next_);
    return tracker_.track(reference, frame, {motion_.priorAt(frame->mid_exposure_ns), frame->exposure.value_or(0.0)});
  }

  /// One frame further.
  MapperOutput step() {
    const auto tracked = std::make_shared<TrackedFrame>(track(*reference_));
    EXPECT_TRUE(tracked->tracked()) << tracked->reason;
    motion_.update(*tracked);
    ++next_;
    MapperOutput output = mapper_.process(tracked);
    if (mapper_.needsRefinement()) draft_ = output.reference;
    while (mapper_.needsRefinement()) output = mapper_.refine();
    if (output.reference) adopt(output.reference);
    return output;
  }

  /// Of the frame that the next step tracks.
  std::uint64_t nextSequence() const { return images_.at(next_)->sequence; }
  bool atEnd() const { return next_ + 1 >= images_.size(); }
  const Reference& reference() const { return *reference_; }

  /// Of the last keyframe, before it was refined.
  ReferenceConstPtr draft() const { return draft_; }

  /// Until there is another keyframe.
  MapperOutput toNextKeyframe() {
    while (!atEnd()) {
      MapperOutput output = step();
      if (output.keyframe) return output;
    }
    ADD_FAILURE() << "no keyframe";
    return {};
  }

 private:
  void adopt(const ReferenceConstPtr& reference) {
    const SE3& T_map_old = reference->T_map_keyframe.at(reference_->id.keyframe_id);
    motion_.changeReference(reference->T_map_reference.inverse() * T_map_old);
    reference_ = reference;
  }

  Mapper& mapper_;
  const std::vector<FrameConstPtr>& images_;
  Tracker tracker_;
  ReferenceConstPtr reference_;
  ReferenceConstPtr draft_;
  MotionState motion_;
  std::size_t next_ = 0;
};

}  // namespace mba_vo::test
