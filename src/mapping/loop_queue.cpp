#include "mba_vo/mapping/loop_queue.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace mba_vo {
namespace {

using Closer = std::unique_ptr<LoopCloser>;

Closer addAll(Closer closer, const std::vector<ArchivedKeyframeConstPtr>& keyframes) {
  for (const ArchivedKeyframeConstPtr& keyframe : keyframes) {
    if (keyframe) {
      closer->add(keyframe);
    } else {
      closer->forgetKeyframes();
    }
  }
  return closer;
}

std::string describe(const LoopTrial& trial) {
  const std::string pair = "keyframes " + std::to_string(trial.older) + " and " + std::to_string(trial.newer) +
                           " of map " + std::to_string(trial.map);
  return trial.verdict.accepted() ? pair + " show one place" : pair + ": " + trial.verdict.rejected_because;
}

}  // namespace

LoopQueue::LoopQueue(const LoopConfig& config, const TrackerConfig& tracker, std::size_t most_waiting)
    : most_waiting_(most_waiting), closer_(std::make_unique<LoopCloser>(config, tracker)) {}

LoopQueue::~LoopQueue() = default;

void LoopQueue::add(const ArchivedKeyframeConstPtr& keyframe) {
  waiting_.push_back(keyframe);
  if (waiting_.size() > most_waiting_) {
    const auto oldest = std::find_if(waiting_.begin(), waiting_.end(), [](const auto& k) { return k != nullptr; });
    waiting_.erase(oldest);
    ++counts_.left_out;
  }
  begin();
}

void LoopQueue::forgetKeyframes() {
  waiting_.push_back(nullptr);
  begin();
}

const LoopCloser& LoopQueue::settled() {
  while (running_.valid() || !waiting_.empty()) {
    if (running_.valid()) running_.wait();
    begin();
  }
  return *closer_;
}

LoopCounts LoopQueue::counts() {
  begin();
  LoopCounts counts = counts_;
  counts.waiting =
      with_thread_ + waiting_.size() - static_cast<std::size_t>(std::count(waiting_.begin(), waiting_.end(), nullptr));
  return counts;
}

/// The thread takes all that waits and the closer with it, and hands the closer back: nothing is shared.
void LoopQueue::begin() {
  if (running_.valid()) {
    if (running_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    takeBack();
  }
  if (waiting_.empty()) return;
  with_thread_ = waiting_.size() - static_cast<std::size_t>(std::count(waiting_.begin(), waiting_.end(), nullptr));
  // A thread inherits the priority of the one that begins it.
  running_ =
      std::async(std::launch::async, [closer = std::move(closer_), keyframes = std::exchange(waiting_, {})]() mutable {
        return addAll(std::move(closer), keyframes);
      });
}

void LoopQueue::takeBack() {
  closer_ = running_.get();
  with_thread_ = 0;
  const std::vector<LoopTrial>& trials = closer_->trials();
  for (std::size_t i = counts_.compared; i < trials.size(); ++i) counts_.closed += trials[i].verdict.accepted() ? 1 : 0;
  counts_.compared = trials.size();
  if (!trials.empty()) counts_.last = describe(trials.back());
}

}  // namespace mba_vo
