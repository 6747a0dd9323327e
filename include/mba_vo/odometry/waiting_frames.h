#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "mba_vo/odometry/recent_frames.h"

namespace mba_vo {

struct WaitingFrame {
  FrameConstPtr frame;
  bool in_time = false;   // its first result came when the frame did
  bool mapped = false;    // the mapper has used it
  bool revision = false;  // it has been tracked before
};

/// Frames that are to be tracked when there is a reference for them, by time. Those that are to be tracked once more
/// come before those that never were.
class WaitingFrames {
 public:
  bool empty() const { return frames_.empty(); }
  std::size_t size() const { return frames_.size(); }
  const WaitingFrame& front() const { return frames_.front(); }
  const WaitingFrame& at(std::size_t place) const { return frames_.at(place); }  // from the front
  const WaitingFrame& back() const { return frames_.back(); }
  double seconds() const;  // from the first to the last
  /// True if there are any and all of them have been tracked before.
  bool areRevisions() const { return !frames_.empty() && frames_.back().revision; }

  void add(const WaitingFrame& frame) { frames_.push_back(frame); }
  /// Frames that came before those that wait.
  void addRevisions(const std::vector<RecentFrames::Entry>& entries);
  WaitingFrame takeFirst();
  void dropUntil(std::int64_t mid_exposure_ns);
  /// Drops what is older than the newest one by more than that [s].
  void dropOlderThan(double most);
  void clear() { frames_.clear(); }

 private:
  std::deque<WaitingFrame> frames_;
};

}  // namespace mba_vo
