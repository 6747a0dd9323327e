#pragma once

#include <deque>
#include <memory>

#include "mba_vo/odometry/tracking_state.h"
#include "mba_vo/odometry/waiting_frames.h"

namespace mba_vo {

/// Frames that a newer one has overtaken while they were being tracked once more. They are tracked to the end against
/// the same reference when there is time; what comes of them makes the trajectory and the map better, and leaves the
/// newest frame's motion alone.
class Revision {
 public:
  Revision() = default;
  Revision(ReferenceConstPtr reference, std::deque<WaitingFrame> frames, const TrackingState& state)
      : reference_(std::move(reference)), frames_(std::move(frames)), state_(state) {}

  bool done() const { return frames_.empty(); }
  const WaitingFrame& next() const { return frames_.front(); }
  /// `frame`: the next one, with the exposure that is believed. Ends with the first one that is lost.
  std::shared_ptr<TrackedFrame> track(const Tracker& tracker, const FrameConstPtr& frame, double unknown_exposure);

 private:
  ReferenceConstPtr reference_;
  std::deque<WaitingFrame> frames_;
  TrackingState state_;
};

}  // namespace mba_vo
