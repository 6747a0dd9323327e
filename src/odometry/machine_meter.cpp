#include "mba_vo/odometry/machine_meter.h"

#include <algorithm>

namespace mba_vo {
namespace {

constexpr double kMillisecondsPerSecond = 1e3;
constexpr double kThousand = 1e3;

}  // namespace

void MachineMeter::Fit::add(double ms, double x) {
  ++count_;
  t_ += ms;
  x_ += x;
  xx_ += x * x;
  xt_ += x * ms;
}

double MachineMeter::Fit::mean() const { return count_ > 0 ? t_ / static_cast<double>(count_) : 0.0; }

double MachineMeter::Fit::slope() const {
  const double n = static_cast<double>(count_);
  const double spread = n * xx_ - x_ * x_;
  return spread > 0.0 ? std::max(0.0, (n * xt_ - x_ * t_) / spread) : 0.0;
}

double MachineMeter::Fit::offset() const {
  return count_ > 0 ? std::max(0.0, mean() - slope() * x_ / static_cast<double>(count_)) : 0.0;
}

void MachineMeter::add(const TrackerStep& step, double seconds) {
  const double ms = kMillisecondsPerSecond * seconds;
  if (step.build_ms > 0.0) image_.add(step.build_ms);
  const TrackedFrameConstPtr& tracked = step.message.tracked;
  if (!tracked) return;
  if (tracked->tracked()) track_.add(ms - step.build_ms, tracked->measures.blur_length_px);
  const bool alone = tracked->orientation_only && tracked->status == TrackingStatus::kInitializing;
  if (alone) orientation_.add(ms - step.build_ms);
}

void MachineMeter::add(const MapperStep& step, double seconds) {
  const double ms = kMillisecondsPerSecond * seconds;
  if (step.kind == MapperStep::Kind::kDeferred) deferred_.add(ms);
  if (step.kind == MapperStep::Kind::kFrame && step.had_time) addFrame(step, ms);
  if (step.kind != MapperStep::Kind::kRefinement) return;
  if (step.output.keyframe) {
    keyframe_.add(ms);
  } else if (step.output.residuals > 0 && !step.output.inserted) {
    iteration_.add(ms, step.output.residuals / kThousand);
  }
}

void MachineMeter::addFrame(const MapperStep& step, double ms) {
  const TrackedFrame& tracked = *step.cause.tracked;
  const double thousands = step.output.residuals / kThousand;
  if (step.output.searched) {
    relocalize_.add(ms);
  } else if (step.output.beginsMap()) {
    first_map_.add(std::max(0.0, ms - look_for_map_.at(thousands)));
  } else if (step.output.inserted) {
    // Depths are searched in that frame first, as in others.
    if (!step.output.keyframe) draft_.add(std::max(0.0, ms - depth_search_.mean()), thousands);
  } else if (tracked.status == TrackingStatus::kInitializing) {
    if (!step.cause.has_reference) look_for_map_.add(ms, thousands);
  } else if (step.output.searched_depths) {
    depth_search_.add(ms);
  }
}

Machine MachineMeter::machine(const Machine& otherwise) const {
  Machine machine = otherwise;
  const auto take = [](const Fit& fit, double& mean) {
    if (!fit.empty()) mean = fit.mean();
  };
  take(image_, machine.image);
  take(orientation_, machine.orientation);
  take(first_map_, machine.first_map);
  take(depth_search_, machine.depth_search);
  take(keyframe_, machine.keyframe);
  take(relocalize_, machine.relocalize);
  take(deferred_, machine.deferred);
  if (!track_.empty()) {
    machine.track = track_.offset();
    machine.track_per_px = track_.slope();
  }
  if (!look_for_map_.empty()) {
    machine.look_for_map = look_for_map_.offset();
    machine.look_for_map_per_1000 = look_for_map_.slope();
  }
  if (!draft_.empty()) {
    machine.draft = draft_.offset();
    machine.draft_per_1000 = draft_.slope();
  }
  if (!iteration_.empty()) {
    machine.iteration = iteration_.offset();
    machine.iteration_per_1000 = iteration_.slope();
  }
  return machine;
}

}  // namespace mba_vo
