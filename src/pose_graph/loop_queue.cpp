#include "mba_vo/pose_graph/loop_queue.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace mba_vo {
namespace {

std::string describe(const LoopTrial& trial) {
  const std::string older = " of map " + std::to_string(trial.older_map);
  const std::string newer = " of map " + std::to_string(trial.newer_map);
  const std::string pair = "keyframes " + std::to_string(trial.older) + (older == newer ? "" : older) + " and " +
                           std::to_string(trial.newer) + newer;
  return trial.verdict.accepted() ? pair + " show one place" : pair + ": " + trial.verdict.rejected_because;
}

}  // namespace

LoopQueue::LoopQueue(const LoopConfig& config, const TrackerConfig& tracker, std::size_t most_waiting)
    : most_waiting_(most_waiting), closer_(std::make_unique<LoopCloser>(config, tracker)) {}

LoopQueue::~LoopQueue() = default;

void LoopQueue::add(const ArchivedKeyframeConstPtr& keyframe) {
  waiting_.push_back({[keyframe](LoopCloser& closer) { closer.add(keyframe); }, true});
  if (comparisonsWaiting() > most_waiting_) {
    waiting_.erase(std::find_if(waiting_.begin(), waiting_.end(), [](const Job& job) { return job.is_comparison; }));
    ++counts_.left_out;
  }
  begin();
}

void LoopQueue::look(const ArchivedKeyframeConstPtr& keyframe, std::vector<ArchivedKeyframeConstPtr> beside) {
  if (!isIdle()) return;
  waiting_.push_back(
      {[keyframe, others = std::move(beside)](LoopCloser& closer) { closer.look(keyframe, others); }, true});
  begin();
}

void LoopQueue::know(const ArchivedKeyframe& keyframe) {
  waiting_.push_back({[keyframe](LoopCloser& closer) { closer.know(archiveForLoops(keyframe)); }});
  begin();
}

void LoopQueue::leave(const std::vector<ArchivedKeyframe>& keyframes) {
  waiting_.push_back({[keyframes](LoopCloser& closer) {
    std::vector<ArchivedKeyframeConstPtr> archived;
    for (const ArchivedKeyframe& keyframe : keyframes) archived.push_back(archiveForLoops(keyframe));
    for (const ArchivedKeyframeConstPtr& keyframe : archived) closer.look(keyframe, archived);
    for (const ArchivedKeyframeConstPtr& keyframe : archived) closer.know(keyframe);
  }});
  begin();
}

void LoopQueue::forgetKeyframes() {
  waiting_.push_back({[](LoopCloser& closer) { closer.forgetKeyframes(); }});
  begin();
}

void LoopQueue::forget(MapId map) {
  forgotten_.insert(map);
  const auto isForgotten = [map](const LoopTrial& loop) { return loop.older_map == map || loop.newer_map == map; };
  found_.loops.erase(std::remove_if(found_.loops.begin(), found_.loops.end(), isForgotten), found_.loops.end());
  waiting_.push_back({[map](LoopCloser& closer) { closer.forget(map); }});
  begin();
}

bool LoopQueue::isIdle() {
  begin();
  return !running_.valid();
}

const LoopCloser& LoopQueue::settled() {
  while (running_.valid() || !waiting_.empty()) {
    if (running_.valid()) running_.wait();
    begin();
  }
  return *closer_;
}

const LoopQueue::Found& LoopQueue::found() {
  begin();
  return found_;
}

LoopCounts LoopQueue::counts() {
  begin();
  LoopCounts counts = counts_;
  counts.waiting = with_thread_ + comparisonsWaiting();
  return counts;
}

std::size_t LoopQueue::comparisonsWaiting() const {
  return static_cast<std::size_t>(
      std::count_if(waiting_.begin(), waiting_.end(), [](const Job& job) { return job.is_comparison; }));
}

/// The thread takes all that waits and the closer with it, and hands the closer back: nothing is shared.
void LoopQueue::begin() {
  if (running_.valid()) {
    if (running_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    takeBack();
  }
  if (waiting_.empty()) return;
  with_thread_ = comparisonsWaiting();
  // A thread inherits the priority of the one that begins it.
  running_ =
      std::async(std::launch::async, [closer = std::move(closer_), jobs = std::exchange(waiting_, {})]() mutable {
        for (const Job& job : jobs) job.work(*closer);
        return std::move(closer);
      });
}

void LoopQueue::takeBack() {
  closer_ = running_.get();
  with_thread_ = 0;
  const std::vector<LoopTrial>& trials = closer_->trials();
  if (std::exchange(closed_, closer_->closed()) != closer_->closed()) takeLoops(trials);
  found_.usual_depths = closer_->usualDepths();
  counts_.closed = found_.loops.size();
  counts_.compared = closer_->compared();
  if (!trials.empty()) counts_.last = describe(trials.back());
}

void LoopQueue::takeLoops(const std::vector<LoopTrial>& trials) {
  found_.loops.clear();
  for (const LoopTrial& trial : trials) {
    const bool is_forgotten = forgotten_.count(trial.older_map) + forgotten_.count(trial.newer_map) > 0;
    if (trial.verdict.accepted() && !is_forgotten) found_.loops.push_back(trial);
  }
}

}  // namespace mba_vo
