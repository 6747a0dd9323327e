#include "mba_vo/odometry/live_simulation.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace mba_vo {
namespace {

constexpr std::size_t kImageQueueBytes = 64000000;    // as the nodes have by default (image_queue_mb)
constexpr std::size_t kMapperQueueBytes = 512000000;  // mapper_queue_mb
constexpr double kBackgroundShare = 0.25;             // of a core that both halves want: niceness 5 weighs a third of 0
// Time that a step takes with images of half the size: docs/decisions/2026-11-27-binned-images.md, median of the ratios
// of tracking a frame.
constexpr double kTimeOfHalfSize = 0.72;
constexpr double kDone = 1e-9;  // [s] less work than that is none

}  // namespace

LiveSimulation::LiveSimulation(const OdometryConfig& config, const Machine& machine,
                               const PhotometricCalibration& photometric)
    : tracker_({config, photometric, kImageQueueBytes, false}),
      mapper_(config.mapper, kMapperQueueBytes),
      machine_(machine) {}

OdometryResult LiveSimulation::process(const CameraImage& image) {
  OdometryResult result;
  if (!first_ns_) first_ns_ = image.mid_exposure_ns;
  const double arrival = 1e-9 * static_cast<double>(image.mid_exposure_ns - *first_ns_);
  runUntil(arrival, result);
  now_ = arrival;  // after a clock that began anew, time jumps
  for (const CameraImage& shed : tracker_.addImage(image, arrival)) {
    result.images.push_back({stepOfShed(shed, "the tracker does not keep up with the camera"), now_});
  }
  return result;
}

OdometryResult LiveSimulation::finish() {
  OdometryResult result;
  runUntil(std::numeric_limits<double>::infinity(), result);
  at_end_ = true;
  runUntil(std::numeric_limits<double>::infinity(), result);
  return result;
}

void LiveSimulation::runUntil(double time, OdometryResult& result) {
  while (now_ < time) {
    startWork();
    if (!tracking_ && !mapping_) return;
    const double next = timeOfNextEvent(time);
    work(next - now_);
    now_ = next;
    endWork(result);
  }
}

void LiveSimulation::startWork() {
  if (!tracking_) {
    if (auto step = at_end_ ? tracker_.finishStep() : tracker_.step()) {
      if (step->message.tracked) adoptSize(step->message.tracked->frame->pyramid.level(0).camera);
      const double seconds = size_factor_ * machine_.secondsFor(*step);
      tracking_ = TrackerWork{std::move(*step), seconds};
    }
  }
  if (!mapping_) {
    if (auto step = mapper_.step()) {
      const StepTime time = machine_.timeFor(*step);
      mapping_ = MapperWork{std::move(*step), {size_factor_ * time.serial, size_factor_ * time.parallel}};
    }
  }
}

/// As images are larger when a run begins, or never.
void LiveSimulation::adoptSize(const PinholeCamera& camera) {
  if (largest_width_ == 0) largest_width_ = camera.width;
  size_factor_ = camera.width < largest_width_ ? kTimeOfHalfSize : 1.0;
}

double LiveSimulation::mapperRate() const {
  if (!mapping_) return 0.0;
  const double usable = mapping_->left.serial > 0.0 ? std::min(1.0, machine_.cores) : machine_.cores;
  if (!tracking_) return usable;
  return std::min(usable, std::max(machine_.cores - 1.0, kBackgroundShare * std::min(1.0, machine_.cores)));
}

double LiveSimulation::trackerRate() const { return tracking_ ? std::min(1.0, machine_.cores - mapperRate()) : 0.0; }

double LiveSimulation::timeOfNextEvent(double latest) {
  double next = latest;
  if (tracking_) next = std::min(next, now_ + tracking_->left / trackerRate());
  if (mapping_) next = std::min(next, now_ + mapping_->part() / mapperRate());
  return next;
}

void LiveSimulation::work(double seconds) {
  const double mapped = seconds * mapperRate();
  const double tracked = seconds * trackerRate();
  if (mapping_) {
    double& part = mapping_->part();
    part = part - mapped < kDone ? 0.0 : part - mapped;
  }
  if (tracking_) tracking_->left -= tracked;
}

void LiveSimulation::endWork(OdometryResult& result) {
  if (mapping_ && mapping_->left.sum() < kDone) {
    const MapperWork done = *std::exchange(mapping_, std::nullopt);
    result.mapping.push_back(done.step.output);
    if (done.step.reference.reference) tracker_.addReference(done.step.reference);
  }
  if (tracking_ && tracking_->left < kDone) endTracking(result);
}

void LiveSimulation::endTracking(OdometryResult& result) {
  const TrackerStep step = std::exchange(tracking_, std::nullopt)->step;
  if (step.message.tracked) mapper_.addFrame(step.message);
  for (const TrackerMessage& placed : step.placed) mapper_.addFrame(placed);
  switch (step.kind) {
    case TrackerStep::Kind::kImage:
    case TrackerStep::Kind::kRepeated:
    case TrackerStep::Kind::kRejected:
    case TrackerStep::Kind::kShed:
      result.images.push_back({step, now_});
      break;
    case TrackerStep::Kind::kLate:
      result.late.push_back(step.message.tracked);
      break;
    case TrackerStep::Kind::kReset:
    case TrackerStep::Kind::kPassed:
      break;
  }
}

}  // namespace mba_vo
