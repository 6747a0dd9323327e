#include "mba_vo/odometry/revision.h"

namespace mba_vo {

std::shared_ptr<TrackedFrame> Revision::track(const Tracker& tracker, const FrameConstPtr& frame,
                                              double unknown_exposure) {
  auto tracked =
      std::make_shared<TrackedFrame>(tracker.track(*reference_, frame, state_.guessFor(*frame, unknown_exposure)));
  frames_.pop_front();
  if (tracked->tracked()) {
    state_.update(*tracked);
  } else {
    frames_.clear();
  }
  return tracked;
}

}  // namespace mba_vo
