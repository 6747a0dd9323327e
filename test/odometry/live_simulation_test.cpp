#include "mba_vo/odometry/live_simulation.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/odometry.h"
#include "odometry/outcome.h"
#include "support/rendered_sequence.h"

namespace mba_vo::live_simulation_test {
namespace {

using test::Outcome;

constexpr double kExposure = 0.03;  // [s]
constexpr int kImages = 70;
constexpr double kLeastShare = 0.6;  // of the images since the map that have a pose

test::RenderedSequence rendered(int images) {
  SimulationConfig config = test::sequenceConfig(kExposure);
  config.trajectory_seed = 3;
  return test::renderFrames(config, 0, images);
}

const test::RenderedSequence& sequence() {
  static const test::RenderedSequence once = rendered(kImages);
  return once;
}

using Images = std::vector<PublishedImage>;

struct LiveRun {
  Images images;
  std::vector<Outcome> outcomes;
  std::set<std::uint64_t> late;  // images that had to wait, and were tracked then
  int keyframes = 0;
};

LiveRun runOn(const Machine& machine, const test::RenderedSequence& seen = sequence()) {
  OdometryConfig config;
  config.mapper.deterministic = true;
  finalize(config);
  LiveSimulation live(config, machine);
  live.setCalibration(seen.calibration, {});
  LiveRun run;
  const auto take = [&](const OdometryResult& result) {
    for (const PublishedImage& image : result.images) {
      run.images.push_back(image);
      if (image.step.message.tracked) {
        run.outcomes.push_back(test::outcomeOf(*image.step.message.tracked, image.step.T_odom_camera));
      }
    }
    for (const TrackedFrameConstPtr& late : result.late) run.late.insert(late->frame->sequence);
    for (const MapperOutput& output : result.mapping) run.keyframes += output.keyframe ? 1 : 0;
  };
  for (const SimulatedFrame& frame : seen.frames) {
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

bool hasPose(const PublishedImage& image) {
  return image.step.message.tracked && image.step.message.tracked->tracked();
}

int posesOf(const LiveRun& run) {
  return static_cast<int>(std::count_if(run.images.begin(), run.images.end(), hasPose));
}

/// Images that had to wait for others and were never tracked.
int leftOutOf(const LiveRun& run) {
  return static_cast<int>(std::count_if(run.images.begin(), run.images.end(), [&](const PublishedImage& image) {
    const TrackerMessage& message = image.step.message;
    return message.has_reference && message.tracked->status == TrackingStatus::kInitializing &&
           run.late.count(image.step.sequence) == 0;
  }));
}

Images::const_iterator firstMapped(const LiveRun& run) {
  const auto isMapped = [](const PublishedImage& image) { return image.step.message.has_reference; };
  return std::find_if(run.images.begin(), run.images.end(), isMapped);
}

/// Of the images from `first` on: with a pose when they were published.
double shareOfPoses(Images::const_iterator first, const LiveRun& run) {
  return static_cast<double>(std::count_if(first, run.images.end(), hasPose)) /
         static_cast<double>(std::distance(first, run.images.end()));
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
  const auto map = firstMapped(run);
  ASSERT_NE(map, run.images.end());
  const auto pose = std::find_if(map, run.images.end(), hasPose);
  ASSERT_NE(pose, run.images.end());
  EXPECT_LT(pose->published - map->published, 2.0);
  EXPECT_GE(shareOfPoses(map, run), kLeastShare);
}

/// So slow that without thinning out what waits there would never be a pose.
TEST(LiveSimulation, WhatWaitsIsThinnedOutUntilItIsCaughtUpWith) {
  constexpr int kMoreImages = 220;
  Machine slow_core = Machine().slowedBy(3.2);
  slow_core.cores = 1.0;
  const LiveRun run = runOn(slow_core, rendered(kMoreImages));
  const auto map = firstMapped(run);
  ASSERT_NE(map, run.images.end());
  EXPECT_GT(leftOutOf(run), 0);
  EXPECT_GE(shareOfPoses(map, run), kLeastShare);
}

/// As a camera of twice the resolution, out of focus, sees it.
test::RenderedSequence enlarged(test::RenderedSequence seen) {
  CameraCalibration& c = seen.calibration;
  c = {2 * c.width, 2 * c.height, 2.0 * c.fx, 2.0 * c.fy, 2.0 * c.cx + 0.5, 2.0 * c.cy + 0.5, "plumb_bob", {}};
  for (SimulatedFrame& frame : seen.frames) cv::resize(frame.blurred, frame.blurred, {}, 2.0, 2.0);
  return seen;
}

int widthOf(const PublishedImage& image) { return image.step.message.tracked->frame->pyramid.level(0).camera.width; }

TEST(LiveSimulation, WhatCannotBeKeptUpWithIsWorkedOnAtHalfTheSize) {
  const LiveRun run = runOn(Machine().slowedBy(6.0), enlarged(sequence()));
  EXPECT_EQ(std::count_if(run.images.begin(), run.images.end(),
                          [](const PublishedImage& image) {
                            return image.step.notice.find("worked on at 376x240 from now on") != std::string::npos;
                          }),
            1);
  EXPECT_EQ(widthOf(run.images.front()), 752);
  EXPECT_EQ(widthOf(run.images.back()), 376);
}

/// Of a camera that stands still, so that there is no map.
CameraImage stillImage(const test::RenderedSequence& seen, std::uint64_t number) {
  CameraImage image;
  image.sequence = number;
  image.stamp_ns = image.mid_exposure_ns = static_cast<std::int64_t>(33000000 * number);
  image.image = seen.frames.front().blurred;
  return image;
}

TEST(Odometry, WhereNoTimePassesImagesKeepTheirSizeHoweverLongTheMapTakes) {
  const test::RenderedSequence seen = enlarged(sequence());
  Odometry odometry(OdometryConfig(), 0);
  odometry.setCalibration(seen.calibration, {});
  for (std::uint64_t i = 0; i < 40; ++i) {
    const OdometryResult result = odometry.process(stillImage(seen, i));
    ASSERT_EQ(result.images.size(), 1U);
    EXPECT_EQ(result.images.front().step.notice, "") << i;
  }
}

/// Whether images are halved where each comes while the one before is worked on, or after that.
bool halves(bool images_wait) {
  const test::RenderedSequence seen = enlarged(sequence());
  TrackerPipelineConfig config;
  config.max_queue_bytes = 64000000;
  TrackerPipeline pipeline(config, 1);
  pipeline.setCalibration(seen.calibration);
  pipeline.step();
  bool halved = false;
  for (std::uint64_t i = 0; i < 40; ++i) {
    pipeline.addImage(stillImage(seen, i));
    const std::optional<TrackerStep> step = pipeline.step();
    halved = halved || (step && !step->notice.empty());
    if (!images_wait) pipeline.step();
  }
  return halved;
}

TEST(TrackerPipeline, ImagesThatHadToWaitAreLoadThoughNoneWaitsBehindThem) {
  EXPECT_TRUE(halves(true));
  EXPECT_FALSE(halves(false));
}

}  // namespace
}  // namespace mba_vo::live_simulation_test
