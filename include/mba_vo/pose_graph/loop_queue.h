#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "mba_vo/pose_graph/loop_closer.h"

namespace mba_vo {

/// What has come of the search for loops so far, in all maps.
struct LoopCounts {
  std::uint64_t waiting = 0;   // keyframes to be looked for, that which is being worked on included
  std::uint64_t left_out = 0;  // keyframes never looked for: the CPU is too slow
  std::uint64_t compared = 0;  // pairs of keyframes that look alike
  std::uint64_t closed = 0;    // of these, show one place
  std::string last;            // which pair was compared last, and what came of it
};

/// Keyframes that have left the window wait here until they are compared with earlier ones, one after the other, on a
/// thread of its own. What comes out depends on the keyframes alone, not on time. Used by one thread, which is held up
/// by settled() only.
class LoopQueue {
 public:
  /// `most_waiting`: of keyframes; the oldest gives way.
  LoopQueue(const LoopConfig& config, const TrackerConfig& tracker, std::size_t most_waiting);
  /// Waits for the comparisons that are under way.
  ~LoopQueue();
  LoopQueue(const LoopQueue&) = delete;
  LoopQueue& operator=(const LoopQueue&) = delete;

  void add(const ArchivedKeyframeConstPtr& keyframe);
  /// LoopCloser::look, if nothing else waits.
  void look(const ArchivedKeyframeConstPtr& keyframe, std::vector<ArchivedKeyframeConstPtr> beside);
  /// LoopCloser::know of a keyframe as the relocaliser has it.
  void know(const ArchivedKeyframe& keyframe);
  /// LoopCloser::look of keyframes of a map that is left, beside each other, and know.
  void leave(const std::vector<ArchivedKeyframe>& keyframes);
  void forgetKeyframes();
  /// LoopCloser::forget.
  void forget(MapId map);
  /// Nothing waits.
  bool isIdle();
  /// What has been found when nothing waits any more.
  const LoopCloser& settled();
  /// By what is known without waiting.
  struct Found {
    std::vector<LoopTrial> loops;          // that have been closed
    std::map<MapId, double> usual_depths;  // LoopCloser::usualDepths, of maps with keyframes
  };
  const Found& found();
  /// By what is known without waiting.
  LoopCounts counts();

 private:
  struct Job {
    std::function<void(LoopCloser&)> work;
    bool is_comparison = false;  // may be left out
  };
  void begin();
  void takeBack();
  void takeLoops(const std::vector<LoopTrial>& trials);
  std::size_t comparisonsWaiting() const;

  std::size_t most_waiting_;
  std::vector<Job> waiting_;
  std::unique_ptr<LoopCloser> closer_;  // null while the thread has it
  std::size_t with_thread_ = 0;         // keyframes
  std::future<std::unique_ptr<LoopCloser>> running_;
  LoopCounts counts_;
  Found found_;
  std::uint64_t closed_ = 0;   // LoopCloser::closed that found_ is of
  std::set<MapId> forgotten_;  // what is found with these does not count
};

}  // namespace mba_vo
