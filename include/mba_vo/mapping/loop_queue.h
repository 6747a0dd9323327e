#pragma once

#include <cstddef>
#include <future>
#include <memory>
#include <vector>

#include "mba_vo/pose_graph/loop_closer.h"

namespace mba_vo {

/// Keyframes that have left the window wait here until they are compared with earlier ones, one after the other, on a
/// thread of its own. What comes out depends on the keyframes alone, not on time. Used by one thread, which is held up
/// by settled() only.
class LoopQueue {
 public:
  LoopQueue(const LoopConfig& config, const TrackerConfig& tracker);
  /// Waits for the comparisons that are under way.
  ~LoopQueue();
  LoopQueue(const LoopQueue&) = delete;
  LoopQueue& operator=(const LoopQueue&) = delete;

  void add(const ArchivedKeyframeConstPtr& keyframe);
  /// Another map begins.
  void forgetKeyframes() { add(nullptr); }
  /// What has been found when nothing waits any more.
  const LoopCloser& settled();

 private:
  void begin(bool wait);

  std::vector<ArchivedKeyframeConstPtr> waiting_;  // null: forget those before
  std::unique_ptr<LoopCloser> closer_;             // null while the thread has it
  std::future<std::unique_ptr<LoopCloser>> running_;
};

}  // namespace mba_vo
