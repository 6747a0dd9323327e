#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mapping/mapper_fixture.h"
#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/odometry.h"
#include "odometry/outcome.h"
#include "support/rendered_sequence.h"

namespace mba_vo::reset_test {
namespace {

using test::expectSame;
using test::Outcome;
using test::outcomeOf;

// After a reset of tracker and mapper, whatever went before, everything must be as if it had never happened: to the
// last bit, save for the number of the map.

constexpr int kFrames = 40;
constexpr double kExposure = 0.03;  // [s]

/// Those of the end-to-end test.
const std::vector<FrameConstPtr>& sequence() {
  static const std::vector<FrameConstPtr> frames = [] {
    SimulationConfig config = test::sequenceConfig(kExposure);
    config.trajectory_seed = 3;
    return test::toFrames(test::renderFrames(config, 0, kFrames), false, kExposure);
  }();
  return frames;
}

/// The same images at another time.
FrameConstPtr moved(const FrameConstPtr& frame, double seconds, bool upside_down = false) {
  auto copy = std::make_shared<Frame>(*frame);
  copy->sequence += 1000;
  copy->mid_exposure_ns += std::llround(1e9 * seconds);
  copy->stamp_ns = copy->mid_exposure_ns;
  if (upside_down) {
    cv::Mat1f mirrored;
    cv::flip(frame->pyramid.level(0).intensity, mirrored, -1);
    copy->pyramid = ImagePyramid(mirrored, frame->pyramid.level(0).camera, frame->pyramid.levels());
  }
  return copy;
}

Odometry makeOdometry() {
  OdometryConfig config;
  config.mapper.deterministic = true;
  finalize(config);
  return Odometry(config, 4);
}

struct Life {
  std::vector<Outcome> outcomes;
  std::vector<std::string> messages;  // the number of the map left out
  std::vector<Outcome> trajectory;    // of the newest map
};

Life live(Odometry& odometry) {
  Life life;
  const auto take = [&](const OdometryResult& result) {
    for (const TrackedFrameConstPtr& late : result.late) life.outcomes.push_back(outcomeOf(*late));
    if (result.tracked()) life.outcomes.push_back(outcomeOf(*result.tracked()));
    for (const MapperOutput& output : result.mapping) {
      life.messages.push_back(output.message.substr(0, output.message.find("map ")) +
                              (output.keyframe ? std::to_string(output.keyframe->keyframe_id) : "-"));
    }
  };
  for (const FrameConstPtr& frame : sequence()) take(odometry.process(frame));
  take(odometry.finish());
  const std::vector<TrajectoryEntry> trajectory = odometry.trajectory();
  MapId newest = 0;
  for (const TrajectoryEntry& entry : trajectory) newest = std::max(newest, entry.map_id);
  for (const TrajectoryEntry& entry : trajectory) {
    if (entry.map_id != newest) continue;
    Outcome outcome;
    outcome.text = std::to_string(entry.frame_sequence);
    outcome.pose = entry.trajectory.T_reference_mid.log();
    outcome.velocity = entry.trajectory.velocity;
    life.trajectory.push_back(outcome);
  }
  return life;
}

struct OdometryState {
  const char* name;
  double seconds;     // from the frames that follow to those before the reset: it may go back in time
  int frames;         // before the reset
  int elsewhere;      // after them, images of another place
  const char* state;  // of the last one
};

std::ostream& operator<<(std::ostream& out, const OdometryState& state) { return out << state.name; }

class ResetOfTheOdometry : public testing::TestWithParam<OdometryState> {};

TEST_P(ResetOfTheOdometry, LeavesNothingBehindButTheTrajectory) {
  static const Life fresh = [] {
    Odometry odometry = makeOdometry();
    return live(odometry);
  }();
  ASSERT_GT(fresh.trajectory.size(), kFrames * 9U / 10U);
  const OdometryState& state = GetParam();
  Odometry odometry = makeOdometry();
  OdometryResult last;
  for (int i = 0; i < state.frames + state.elsewhere; ++i) {
    const bool upside_down = i >= state.frames;
    last = odometry.process(moved(sequence().at(static_cast<std::size_t>(i)), state.seconds, upside_down));
  }
  EXPECT_EQ(std::string(toString(last.tracked()->status)) + (last.late.empty() ? "" : ", others late"), state.state);
  const std::size_t before = odometry.trajectory().size();
  odometry.reset();
  EXPECT_GE(odometry.trajectory().size(), before) << "the trajectory so far is kept";
  const Life again = live(odometry);
  expectSame(again.outcomes, fresh.outcomes);
  expectSame(again.trajectory, fresh.trajectory);
  EXPECT_EQ(again.messages, fresh.messages);
}

const OdometryState kOdometryStates[] = {
    {"Initializing", -100.0, 7, 0, "INITIALIZING"},
    {"WithAReferenceOnItsWay", 100.0, 13, 0, "INITIALIZING"},
    {"CatchingUp", -100.0, 14, 0, "TRACKING, others late"},
    {"Tracking", -100.0, 39, 0, "TRACKING"},
    {"Lost", 100.0, 32, 6, "LOST"},
};

std::string nameOfOdometryState(const testing::TestParamInfo<OdometryState>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(InEveryState, ResetOfTheOdometry, testing::ValuesIn(kOdometryStates), nameOfOdometryState);

TEST(ResetOfTheMapper, ForgetsForHowLongTheTrackerHadNoReference) {
  // Of some frames without a reference at the beginning of a map nothing follows: it may still be on its way.
  constexpr int kNotForLong = 14;
  Mapper mapper(test::config());
  for (int round = 0; round < 2; ++round) {
    ASSERT_NE(test::initialise(mapper).output.reference, nullptr);
    for (int i = 0; i < kNotForLong; ++i) {
      const FrameConstPtr later = test::shifted(test::frames().back(), 1.0 + 0.04 * i);
      EXPECT_EQ(mapper.process(test::report(later, TrackingStatus::kInitializing)).reference, nullptr) << round;
    }
    mapper.reset();
  }
}

}  // namespace
}  // namespace mba_vo::reset_test
