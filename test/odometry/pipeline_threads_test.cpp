// Both halves on threads of their own, as the nodelets run them. The thread sanitizer sees all of it.
#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/mapper_pipeline.h"
#include "mba_vo/odometry/pipeline_thread.h"
#include "mba_vo/odometry/tracker_pipeline.h"
#include "support/rendered_sequence.h"

namespace mba_vo::pipeline_threads_test {
namespace {

constexpr double kExposure = 0.03;  // [s]
constexpr int kImages = 60;
constexpr std::size_t kQueueBytes = 500000000;

const test::RenderedSequence& sequence() {
  static const test::RenderedSequence rendered = [] {
    SimulationConfig config = test::sequenceConfig(kExposure);
    config.trajectory_seed = 3;
    return test::renderFrames(config, 0, kImages);
  }();
  return rendered;
}

OdometryConfig options() {
  OdometryConfig config;
  config.mapper.deblur.method = "trajectory";
  config.mapper.deblur.trajectory.min_blur_px = 1.0;
  config.mapper.deblur_queue.per_second = 5.0;
  finalize(config);
  return config;
}

class Threads {
 public:
  Threads()
      : tracker_({options(), {}, kQueueBytes, true}),
        mapper_(options().mapper, kQueueBytes),
        mapping_({[this] { return map(); }, [this](const std::string& what) { recoverMapper(what); }},
                 PipelineThread::Priority::kBackground),
        tracking_({[this] { return track(); }, [this](const std::string&) { recoverTracker(); }}) {
    tracker_.setCalibration(sequence().calibration);
  }
  ~Threads() {
    tracking_.stop();
    mapping_.stop();
  }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  void add(int index, std::int64_t later_ns = 0) {
    const SimulatedFrame& frame = sequence().frames.at(static_cast<std::size_t>(index));
    CameraImage image;
    image.sequence = ++added_;
    image.stamp_ns = image.mid_exposure_ns = frame.mid_exposure_ns + later_ns;
    image.exposure = kExposure;
    image.image = frame.blurred;
    tracker_.addImage(image);
    tracking_.wake();
    // As fast as the two can, but no faster: what they have no time for they leave out. The tracker does not wait for
    // a trajectory that is being saved.
    while (first_results_ < added_ || (mapper_.queueBytes() > 0 && !saving_))
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  void reset() {
    tracker_.requestReset();
    tracking_.wake();
  }
  void failNextFrame() { fail_mapper_ = true; }
  void failNextImage() { fail_tracker_ = true; }
  std::vector<TrajectoryEntry> trajectory() {
    auto future = mapper_.ask([](const Mapper& mapper) { return mapper.finishedTrajectory(); });
    saving_ = true;
    mapping_.wake();
    std::vector<TrajectoryEntry> entries = future.get();
    saving_ = false;
    return entries;
  }
  bool isSaving() const { return saving_; }
  int mapperFailures() const { return mapper_failures_; }
  int trackerFailures() const { return tracker_failures_; }
  int resets() const { return resets_; }
  /// Keyframes offered for deblurring.
  std::uint64_t offered() const { return offered_; }

 private:
  bool track() {
    const std::optional<TrackerStep> step = tracker_.step();
    if (!step) return false;
    if (step->kind == TrackerStep::Kind::kImage && fail_tracker_.exchange(false))
      throw std::runtime_error("on purpose");
    if (step->kind == TrackerStep::Kind::kReset) ++resets_;
    if (step->message.tracked) {
      mapper_.addFrame(step->message);
      for (const TrackerMessage& placed : step->placed) mapper_.addFrame(placed);
      mapping_.wake();
    }
    if (step->kind == TrackerStep::Kind::kImage) ++first_results_;
    return true;
  }
  bool map() {
    const std::optional<MapperStep> step = mapper_.step();
    offered_ = mapper_.mapper().deblurCounts().offered;
    if (!step) return false;
    if (step->reference.reference) deliver(step->reference);
    if (step->kind == MapperStep::Kind::kFrame && fail_mapper_.exchange(false)) throw std::runtime_error("on purpose");
    return true;
  }
  void deliver(const MapperMessage& reference) {
    tracker_.addReference(reference);
    tracking_.wake();
  }
  void recoverMapper(const std::string& what) {
    ++mapper_failures_;
    const MapperMessage closed = mapper_.recover(what);
    if (closed.reference) deliver(closed);
  }
  void recoverTracker() {
    ++tracker_failures_;
    if (tracker_.imageInWork()) ++first_results_;  // it has none
    tracker_.requestReset();
  }

  TrackerPipeline tracker_;
  MapperPipeline mapper_;
  std::atomic<std::uint64_t> added_{0};
  std::atomic<std::uint64_t> first_results_{0};
  std::atomic<std::uint64_t> offered_{0};
  std::atomic<int> mapper_failures_{0}, tracker_failures_{0}, resets_{0};
  std::atomic<bool> fail_mapper_{false}, fail_tracker_{false}, saving_{false};
  PipelineThread mapping_;
  PipelineThread tracking_;
};

TEST(PipelineThreads, TrackMapSaveResetFailAndEnd) {
  Threads threads;
  std::future<std::vector<TrajectoryEntry>> saved;
  int while_saving = 0;  // images
  for (int i = 0; i < kImages; ++i) {
    while_saving += threads.isSaving() ? 1 : 0;
    threads.add(i);
    if (i != kImages - 20) continue;
    saved = std::async(std::launch::async, [&] { return threads.trajectory(); });
    while (!threads.isSaving()) std::this_thread::yield();
  }
  EXPECT_FALSE(saved.get().empty());
  EXPECT_GT(while_saving, 0);
  const std::size_t first = threads.trajectory().size();
  EXPECT_GT(first, kImages / 2U);
  EXPECT_GT(threads.offered(), 0U);

  threads.reset();
  for (int i = 0; i < kImages; ++i) threads.add(i, 10000000000);
  const std::size_t second = threads.trajectory().size();
  EXPECT_GT(second, first + kImages / 2U);

  threads.failNextFrame();
  for (int i = 0; i < kImages; ++i) threads.add(i, 20000000000);
  EXPECT_EQ(threads.mapperFailures(), 1);
  EXPECT_GT(threads.trajectory().size(), second);

  threads.failNextImage();
  for (int i = 0; i < 30; ++i) threads.add(i, 30000000000);  // and ends while it works
  EXPECT_EQ(threads.trackerFailures(), 1);
  EXPECT_EQ(threads.resets(), 2) << "one that was asked for, one after the failure";
}

}  // namespace
}  // namespace mba_vo::pipeline_threads_test
