#include "mba_vo/odometry/live_simulation.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/odometry/config_yaml.h"
#include "odometry/outcome.h"
#include "support/rendered_sequence.h"

namespace mba_vo {
namespace {

using test::Outcome;

constexpr double kExposure = 0.03;  // [s]
constexpr int kImages = 70;

const test::RenderedSequence& sequence() {
  static const test::RenderedSequence rendered = [] {
    SimulationConfig config = test::sequenceConfig(kExposure);
    config.trajectory_seed = 3;
    return test::renderFrames(config, 0, kImages);
  }();
  return rendered;
}

struct LiveRun {
  std::vector<PublishedImage> images;
  std::vector<Outcome> outcomes;
  int keyframes = 0;
};

LiveRun runOn(const Machine& machine) {
  OdometryConfig config;
  config.mapper.deterministic = true;
  finalize(config);
  LiveSimulation live(config, machine);
  live.setCalibration(sequence().calibration, {});
  LiveRun run;
  const auto take = [&](const OdometryResult& result) {
    for (const PublishedImage& image : result.images) {
      run.images.push_back(image);
      if (image.step.message.tracked) {
        run.outcomes.push_back(test::outcomeOf(*image.step.message.tracked, image.step.T_odom_camera));
      }
    }
    for (const MapperOutput& output : result.mapping) run.keyframes += output.keyframe ? 1 : 0;
  };
  for (const SimulatedFrame& frame : sequence().frames) {
    CameraImage image;
    image.sequence = frame.id;
    image.stamp_ns = image.mid_exposure_ns = frame.mid_exposure_ns;
    image.exposure = kExposure;
    image.image = frame.blurred;
    take(live.process(image));
  }
  take(live.finish());
  return run;
}

int posesOf(const LiveRun& run) {
  return static_cast<int>(std::count_if(run.images.begin(), run.images.end(), [](const PublishedImage& image) {
    return image.step.message.tracked && image.step.message.tracked->tracked();
  }));
}

double worstLatency(const LiveRun& run) {
  double worst = 0.0;
  for (const PublishedImage& image : run.images) worst = std::max(worst, image.published - image.step.arrival);
  return worst;
}

TEST(LiveSimulation, EveryImageIsAccountedForAndNothingIsPublishedBeforeItCame) {
  const LiveRun run = runOn(Machine());
  ASSERT_EQ(run.images.size(), sequence().frames.size());
  for (const PublishedImage& image : run.images) EXPECT_GE(image.published, image.step.arrival);
  EXPECT_GT(worstLatency(run), 1e-3);
  EXPECT_GE(run.keyframes, 3);
  EXPECT_GE(posesOf(run), kImages / 2);
}

TEST(LiveSimulation, TheSameMachineGoesTheSameWay) {
  const LiveRun first = runOn(Machine());
  const LiveRun second = runOn(Machine());
  test::expectSame(second.outcomes, first.outcomes);
  ASSERT_EQ(second.images.size(), first.images.size());
  for (std::size_t i = 0; i < first.images.size(); ++i)
    EXPECT_EQ(second.images[i].published, first.images[i].published);
}

TEST(LiveSimulation, OnASlowerMachinePosesComeLaterAndAreFewer) {
  const LiveRun fast = runOn(Machine().slowedBy(0.1));
  const LiveRun slow = runOn(Machine().slowedBy(4.0));
  EXPECT_GT(posesOf(fast), posesOf(slow));
  EXPECT_GT(worstLatency(slow), 2.0 * worstLatency(fast));
  ASSERT_EQ(slow.images.size(), sequence().frames.size());
}

TEST(LiveSimulation, OverloadIsNotSilence) {
  Machine one_core = Machine();
  one_core.cores = 1.0;
  const LiveRun run = runOn(one_core);
  const auto isMapped = [](const PublishedImage& image) { return image.step.message.has_reference; };
  const auto map = std::find_if(run.images.begin(), run.images.end(), isMapped);
  ASSERT_NE(map, run.images.end());
  const auto pose = std::find_if(map, run.images.end(), [](const PublishedImage& image) {
    return image.step.message.tracked && image.step.message.tracked->tracked();
  });
  ASSERT_NE(pose, run.images.end());
  EXPECT_LT(pose->published - map->published, 2.0);
}

}  // namespace
}  // namespace mba_vo
