#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "io/temporary_folder.h"
#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/odometry.h"
#include "odometry/outcome.h"
#include "support/rendered_sequence.h"

namespace mba_vo::deblurring_test {
namespace {

using test::Outcome;

constexpr int kImages = 40;
constexpr double kExposure = 0.03;  // [s]

const std::vector<FrameConstPtr>& images() {
  static const std::vector<FrameConstPtr> kFrames = [] {
    SimulationConfig config = test::sequenceConfig(kExposure);
    config.trajectory_seed = 3;
    return test::toFrames(test::renderFrames(config, 0, kImages), false, kExposure);
  }();
  return kFrames;
}

Odometry makeOdometry(const std::string& method, bool check = false, const std::string& images = "") {
  OdometryConfig config;
  config.mapper.deterministic = true;
  config.mapper.deblur.method = method;
  config.mapper.deblur.check = check;
  config.mapper.deblur.folder.images = images;
  config.mapper.deblur.trajectory.min_blur_px = 1.0;
  config.mapper.deblur.trajectory.max_disagreement = 10.0;
  config.mapper.deblur_queue.per_second = 5.0;
  finalize(config);
  return Odometry(config, 0);
}

std::vector<Outcome> run(Odometry& odometry) {
  std::vector<Outcome> outcomes;
  const auto take = [&](const OdometryResult& result) {
    for (const TrackedFrameConstPtr& late : result.late) outcomes.push_back(test::outcomeOf(*late));
    if (result.tracked()) outcomes.push_back(test::outcomeOf(*result.tracked()));
  };
  for (const FrameConstPtr& frame : images()) take(odometry.process(frame));
  take(odometry.finish());
  return outcomes;
}

TEST(Deblurring, DeterministicRunsDoNotDependOnTime) {
  Odometry odometry = makeOdometry("trajectory");
  const std::vector<Outcome> first = run(odometry);
  const DeblurCounts counts = odometry.mapper().deblurCounts();
  EXPECT_GT(counts.sharpened, 1U);
  EXPECT_EQ(counts.too_slow, 0U) << "each result is waited for";

  Odometry again = makeOdometry("trajectory");
  test::expectSame(run(again), first);

  Odometry without = makeOdometry("none");
  const std::vector<Outcome> blurred = run(without);
  EXPECT_NE(blurred.back().pose, first.back().pose);
}

/// The images of the folder stand on their heads: none can get into the map.
TEST(Deblurring, WhereNoSharpImageGetsIntoTheMapAllIsAsWithout) {
  const TemporaryFolder folder;
  for (const FrameConstPtr& frame : images()) {
    char name[32];
    std::snprintf(name, sizeof(name), "%06d.png", static_cast<int>(frame->sequence));
    cv::Mat1f wrong;
    cv::flip(frame->pyramid.level(0).intensity, wrong, 0);
    cv::imwrite(folder.file(name), wrong);
  }
  Odometry odometry = makeOdometry("folder", true, folder.file(""));
  const std::vector<Outcome> outcomes = run(odometry);
  EXPECT_GT(odometry.mapper().deblurCounts().sharpened, 1U);
  EXPECT_EQ(odometry.mapper().deblurCounts().in_map, 0U);

  Odometry without = makeOdometry("none");
  test::expectSame(outcomes, run(without));
}

TEST(Deblurring, AResetLeavesNoSharpKeyframeBehind) {
  Odometry fresh = makeOdometry("trajectory");
  const std::vector<Outcome> expected = run(fresh);
  Odometry odometry = makeOdometry("trajectory");
  std::size_t next = 0;
  const auto isBusy = [&] {
    return odometry.mapper().deblurCounts().sharpened > 0 && odometry.mapper().deblurCounts().waiting > 0;
  };
  while (!isBusy() && next < images().size()) odometry.process(images()[next++]);
  ASSERT_TRUE(isBusy());
  odometry.reset();
  EXPECT_EQ(odometry.mapper().deblurCounts().waiting, 0U);
  const std::vector<Outcome> after = run(odometry);
  ASSERT_EQ(after.size(), expected.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].pose, expected[i].pose) << i;
    EXPECT_EQ(after[i].velocity, expected[i].velocity) << i;
  }
}

}  // namespace
}  // namespace mba_vo::deblurring_test
