#include "mba_vo/evaluation/availability.h"

#include <algorithm>
#include <limits>

#include "mba_vo/evaluation/statistics.h"

namespace mba_vo {
namespace {

constexpr double kRounding = 1e-6;  // of the stamps as written [s]

/// An image that shows another one again was not to be tracked.
std::vector<OnlineFrame> withoutRepeats(std::vector<OnlineFrame> frames) {
  const auto repeats = [](const OnlineFrame& frame) { return frame.status == OnlineStatus::kRepeated; };
  frames.erase(std::remove_if(frames.begin(), frames.end(), repeats), frames.end());
  return frames;
}

double medianInterval(const std::vector<OnlineFrame>& frames) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const double interval = frames[i].time - frames[i - 1].time;
    if (interval > 0.0) {  // clocks that begin anew tell nothing
      intervals.push_back(interval);
    }
  }
  return intervals.empty() ? 0.0 : summarize(intervals).median;
}

template <typename Selected, typename Counted>
Share share(const std::vector<OnlineFrame>& frames, const Selected& selected, const Counted& counted) {
  Share result;
  for (const OnlineFrame& frame : frames) {
    if (selected(frame)) {
      ++result.of;
      result.count += counted(frame) ? 1 : 0;
    }
  }
  return result;
}

Latency poseLatency(const std::vector<OnlineFrame>& frames) {
  std::vector<double> latencies;
  for (const OnlineFrame& frame : frames) {
    if (frame.hasPose()) {
      latencies.push_back(frame.latency());
    }
  }
  if (latencies.empty()) {
    return {kNone, kNone, kNone};
  }
  std::sort(latencies.begin(), latencies.end());
  return {quantile(latencies, 0.5), quantile(latencies, 0.95), quantile(latencies, 0.99)};
}

/// When the first pose was published, as mid-exposure plus latency: image times and the run's clock differ by a
/// constant that nobody knows.
std::optional<double> timeOfFirstPose(const std::vector<OnlineFrame>& frames) {
  const OnlineFrame* first = nullptr;
  for (const OnlineFrame& frame : frames) {
    if (frame.hasPose() && (first == nullptr || *frame.published < *first->published)) {
      first = &frame;
    }
  }
  return first == nullptr ? std::nullopt : std::optional<double>(first->time + first->latency());
}

/// What follows the first image with a pose: how long and how often the poses in time were interrupted.
template <typename InTime>
void measureInterruptions(const std::vector<OnlineFrame>& frames, const InTime& in_time, Availability& availability) {
  const auto first =
      std::find_if(frames.begin(), frames.end(), [](const OnlineFrame& frame) { return frame.hasPose(); });
  if (first == frames.end()) {
    return;
  }
  double longest = 0.0;
  double last_pose = first->time;
  for (auto frame = std::next(first); frame != frames.end(); ++frame) {
    longest = std::max(longest, frame->time - last_pose);
    ++availability.missed_after_first.of;
    if (in_time(*frame)) {
      last_pose = frame->time;
    } else {
      ++availability.missed_after_first.count;
      last_pose = std::min(last_pose, frame->time);  // a clock that begins anew
    }
  }
  availability.longest_gap = longest;
}

}  // namespace

Availability measureAvailability(const std::vector<OnlineFrame>& all, std::optional<double> parallax_time) {
  Availability availability;
  for (const OnlineFrame& frame : all) {
    ++availability.images_by_status[toString(frame.status)];
  }
  const std::vector<OnlineFrame> frames = withoutRepeats(all);
  availability.frame_interval = medianInterval(frames);
  const auto soon = [limit = availability.frame_interval + kRounding](const OnlineFrame& frame) {
    return frame.latency() <= limit;
  };
  const auto pose_in_time = [&](const OnlineFrame& frame) { return frame.hasPose() && soon(frame); };
  const auto orientation_in_time = [&](const OnlineFrame& frame) { return frame.hasOrientation() && soon(frame); };
  const auto any = [](const OnlineFrame&) { return true; };
  constexpr double kTimeToBegin = 0.3;  // that a map may take [s]
  const auto moving = [&](const OnlineFrame& frame) {
    return parallax_time && frame.time > *parallax_time + kTimeToBegin + kRounding;
  };
  availability.pose_in_time = share(frames, any, pose_in_time);
  availability.pose_in_time_moving = share(frames, moving, pose_in_time);
  availability.orientation_in_time = share(frames, any, orientation_in_time);
  availability.orientation_in_time_moving = share(frames, moving, orientation_in_time);
  if (const std::optional<double> first = timeOfFirstPose(frames)) {
    availability.first_pose_after_start = *first - frames.front().time;
    if (parallax_time) {
      availability.first_pose_after_parallax = *first - *parallax_time;
    }
  }
  measureInterruptions(frames, pose_in_time, availability);
  availability.latency = poseLatency(frames);
  return availability;
}

}  // namespace mba_vo
