#include "mba_vo/odometry/mapper_pipeline.h"

#include <algorithm>
#include <utility>

namespace mba_vo {
namespace {

constexpr std::size_t kBacklog = 3;  // frames that wait: the mapper is behind, by a tenth of a second at 30 Hz

/// A frame that no map depends on: it refines depths and has a row in the trajectory, but others do so too.
bool isOrdinary(const TrackedFrame& tracked) { return tracked.tracked() && !tracked.keyframe_requested; }

}  // namespace

MapperPipeline::MapperPipeline(const MapperConfig& config, std::size_t max_queue_bytes)
    : queue_(max_queue_bytes, bytesOf, mostDispensable), mapper_(config) {}

std::vector<TrackerMessage> MapperPipeline::addFrame(const TrackerMessage& message) {
  std::vector<TrackerMessage> shed;
  for (const Job& job : queue_.push(message)) shed.push_back(std::get<TrackerMessage>(job));
  return shed;
}

std::optional<MapperStep> MapperPipeline::step() {
  MapperStep step;
  if (const std::optional<Job> job = queue_.pop()) {
    if (const auto* message = std::get_if<TrackerMessage>(&*job)) return take(*message);
    if (const auto* question = std::get_if<Question>(&*job)) {
      (*question)(mapper_);
    } else {
      step.reference = closeMap("another map was loaded");
      mapper_.beginIn(*std::get<std::shared_ptr<const SavedMap>>(*job));
    }
    return step;
  }
  if (mapper_.needsRefinement()) return refine();
  if (!mapper_.doDeferredWork()) return std::nullopt;
  step.kind = MapperStep::Kind::kDeferred;
  return step;
}

MapperMessage MapperPipeline::recover(const std::string& reason) {
  MapperMessage closed = closeMap(reason);
  mapper_.abandonMap();
  return closed;
}

MapperMessage MapperPipeline::closeMap(const std::string& reason) {
  const ReferenceConstPtr current = mapper_.currentReference();
  map_id_ = 0;
  if (!current) return {};
  auto closed = std::make_shared<Reference>(*current);
  closed->cause = ReferenceCause::kMapClosed;
  closed->closed_because = reason;
  return {session_, closed};
}

void MapperPipeline::reset() {
  mapper_.reset();
  map_id_ = 0;
}

MapperStep MapperPipeline::take(const TrackerMessage& message) {
  MapperStep step;
  step.kind = MapperStep::Kind::kFrame;
  step.cause = newest_ = message;
  step.was_reset = followSession(message);
  step.stale = message.tracked->tracked() && message.tracked->reference.map_id != map_id_;
  step.had_time = queue_.size() < kBacklog;
  step.output = mapper_.process(message.tracked, step.had_time);
  address(step);
  return step;
}

MapperStep MapperPipeline::refine() {
  MapperStep step;
  step.kind = MapperStep::Kind::kRefinement;
  step.cause = newest_;
  step.output = mapper_.refine();
  address(step);
  return step;
}

/// To the tracker of the session.
void MapperPipeline::address(MapperStep& step) {
  if (!step.output.reference) return;
  map_id_ = step.output.reference->id.map_id;
  step.reference = {session_, step.output.reference};
}

/// A tracker that was merely restarted is given the current reference; one that was reset wants a new map.
bool MapperPipeline::followSession(const TrackerMessage& message) {
  if (message.session == session_) return false;
  const bool another = std::exchange(session_, message.session) != 0;
  if (!another || message.keep_map) return false;
  reset();
  return true;
}

std::size_t MapperPipeline::bytesOf(const Job& job) {
  const auto* message = std::get_if<TrackerMessage>(&job);
  if (!message) return 0;
  const Frame& frame = *message->tracked->frame;
  return frame.pyramid.bytes() + frame.depth.total() * sizeof(float);
}

/// The oldest ordinary frame, or else the oldest frame.
std::size_t MapperPipeline::mostDispensable(const std::deque<Job>& jobs) {
  std::size_t oldest = jobs.size();
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const auto* message = std::get_if<TrackerMessage>(&jobs[i]);
    if (!message) continue;
    if (isOrdinary(*message->tracked)) return i;
    oldest = std::min(oldest, i);
  }
  return oldest;
}

}  // namespace mba_vo
