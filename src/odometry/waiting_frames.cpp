#include "mba_vo/odometry/waiting_frames.h"

#include <utility>

namespace mba_vo {

void WaitingFrames::addRevisions(const std::vector<RecentFrames::Entry>& entries) {
  std::vector<WaitingFrame> again;
  again.reserve(entries.size());
  for (const RecentFrames::Entry& entry : entries) again.push_back({entry.frame, entry.in_time, entry.mapped, true});
  frames_.insert(frames_.begin(), again.begin(), again.end());
}

WaitingFrame WaitingFrames::takeFirst() {
  WaitingFrame first = std::move(frames_.front());
  frames_.pop_front();
  return first;
}

void WaitingFrames::dropUntil(std::int64_t mid_exposure_ns) {
  while (!frames_.empty() && frames_.front().frame->mid_exposure_ns <= mid_exposure_ns) frames_.pop_front();
}

double WaitingFrames::seconds() const {
  if (frames_.empty()) return 0.0;
  return 1e-9 * static_cast<double>(frames_.back().frame->mid_exposure_ns - frames_.front().frame->mid_exposure_ns);
}

void WaitingFrames::dropOlderThan(double most) {
  while (seconds() > most) frames_.pop_front();
}

}  // namespace mba_vo
