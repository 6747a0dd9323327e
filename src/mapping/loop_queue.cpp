#include "mba_vo/mapping/loop_queue.h"

#include <chrono>
#include <utility>

namespace mba_vo {
namespace {

void addTo(LoopCloser& closer, const ArchivedKeyframeConstPtr& keyframe) {
  if (keyframe) {
    closer.add(keyframe);
  } else {
    closer.forgetKeyframes();
  }
}

}  // namespace

LoopQueue::LoopQueue(const LoopConfig& config, const TrackerConfig& tracker)
    : closer_(std::make_unique<LoopCloser>(config, tracker)) {}

LoopQueue::~LoopQueue() = default;

void LoopQueue::add(const ArchivedKeyframeConstPtr& keyframe) {
  waiting_.push_back(keyframe);
  begin(false);
}

const LoopCloser& LoopQueue::settled() {
  while (running_.valid() || !waiting_.empty()) begin(true);
  return *closer_;
}

/// The thread takes all that waits and the closer with it, and hands the closer back: nothing is shared.
void LoopQueue::begin(bool wait) {
  if (running_.valid()) {
    if (!wait && running_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    closer_ = running_.get();
  }
  if (waiting_.empty()) return;
  running_ =
      std::async(std::launch::async, [closer = std::move(closer_), keyframes = std::exchange(waiting_, {})]() mutable {
        for (const ArchivedKeyframeConstPtr& keyframe : keyframes) addTo(*closer, keyframe);
        return std::move(closer);
      });
}

}  // namespace mba_vo
