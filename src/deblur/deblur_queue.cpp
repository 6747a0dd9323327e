#include "mba_vo/deblur/deblur_queue.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

namespace mba_vo {
namespace {

/// A deblurrer that fails, a network for instance, leaves the keyframe as it is.
DeblurResult deblurOrLeave(const Deblurrer& deblurrer, const DeblurInput& input) {
  try {
    return deblurrer.deblur(input);
  } catch (const std::exception& error) {
    DeblurResult result;
    result.image = input.image;
    result.reason = error.what();
    return result;
  }
}

/// The deblurrer has looked at the keyframe and not even tried.
bool wasFree(const DeblurResult& result) { return !result.sharpened && !(result.residual > 0.0F); }

}  // namespace

DeblurQueue::DeblurQueue(const DeblurQueueConfig& config, std::shared_ptr<const Deblurrer> deblurrer, bool waits)
    : config_(config), deblurrer_(std::move(deblurrer)), waits_(waits) {}

void DeblurQueue::offer(DeblurTask task) {
  ++counts_.offered;
  const auto hasLess = [&](const Waiting& other) { return other.task.blur_px < task.blur_px; };
  const auto place = std::find_if(waiting_.begin(), waiting_.end(), hasLess);
  waiting_.insert(place, {std::move(task), false});
  if (static_cast<int>(waiting_.size()) <= config_.length) return;
  giveUp(waiting_.back());
  waiting_.pop_back();
}

std::optional<DeblurredKeyframe> DeblurQueue::take(const IsKept& isKept) {
  if (!running_) return std::nullopt;
  if (!waits_ && running_->result.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  DeblurredKeyframe done{running_->keyframe, running_->result.get()};
  const bool wanted = running_->wanted;
  running_.reset();
  if (!wanted) return std::nullopt;
  if (wasFree(done.result)) {  // it does not count as a turn
    begun_ns_.reset();
    missed_ns_.reset();
  }
  if (!done.result.sharpened) {
    ++counts_.unsuited;
    counts_.unsuited_reason = done.result.reason;
    return std::nullopt;
  }
  if (!isKept(done.keyframe)) {
    ++counts_.too_slow;
    return std::nullopt;
  }
  ++counts_.sharpened;
  return done;
}

void DeblurQueue::begin(std::int64_t now_ns, const IsKept& isKept) {
  dropDeparted(isKept);
  if (waiting_.empty() || !isPeriodSince(begun_ns_, now_ns)) return;
  if (running_) {
    if (!isPeriodSince(missed_ns_, now_ns)) return;
    waiting_.front().held_up = true;
    missed_ns_ = now_ns;
    return;
  }
  const auto task = std::make_shared<const DeblurTask>(std::move(waiting_.front().task));
  waiting_.erase(waiting_.begin());
  begun_ns_ = missed_ns_ = now_ns;
  // A thread inherits the priority of the one that begins it.
  auto result =
      std::async(std::launch::async, [deblurrer = deblurrer_, task] { return deblurOrLeave(*deblurrer, task->input); });
  running_ = Running{task->keyframe, true, std::move(result)};
}

void DeblurQueue::clear() {
  counts_.forgotten += waiting_.size();
  waiting_.clear();
  begun_ns_.reset();
  missed_ns_.reset();
  if (!running_) return;
  counts_.forgotten += running_->wanted ? 1 : 0;
  running_->wanted = false;
  if (waits_) running_.reset();
}

DeblurCounts DeblurQueue::counts() const {
  DeblurCounts counts = counts_;
  counts.waiting = waiting_.size() + (running_ && running_->wanted ? 1 : 0);
  return counts;
}

void DeblurQueue::giveUp(const Waiting& waiting) { ++(waiting.held_up ? counts_.too_slow : counts_.passed_over); }

void DeblurQueue::dropDeparted(const IsKept& isKept) {
  const auto departed = [&](const Waiting& waiting) {
    if (isKept(waiting.task.keyframe)) return false;
    giveUp(waiting);
    return true;
  };
  waiting_.erase(std::remove_if(waiting_.begin(), waiting_.end(), departed), waiting_.end());
}

/// Also if the clock has gone back.
bool DeblurQueue::isPeriodSince(const std::optional<std::int64_t>& turn_ns, std::int64_t now_ns) const {
  return !turn_ns || now_ns < *turn_ns || 1e-9 * static_cast<double>(now_ns - *turn_ns) * config_.per_second >= 1.0;
}

}  // namespace mba_vo
