#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/odometry/odometry.h"
#include "support/rendered_sequence.h"

namespace mba_vo::reference_delay_test {
namespace {

struct Step {
  std::optional<ReferenceId> used;     // by the tracker for this frame
  std::optional<ReferenceId> emitted;  // by the mapper because of this frame
};

/// Sharp images are enough to tell which reference is used when.
const std::vector<FrameConstPtr>& frames() {
  constexpr int kFrames = 60;
  static const std::vector<FrameConstPtr> frames =
      test::toFrames(test::renderFrames(test::sequenceConfig(0.0), 0, kFrames), true, 0.0);
  return frames;
}

std::vector<Step> runSteps(int delay) {
  OdometryConfig config;
  config.mapper.deterministic = true;
  Odometry odometry(config, delay);
  std::vector<Step> steps;
  for (const FrameConstPtr& frame : frames()) {
    const OdometryResult result = odometry.process(frame);
    steps.emplace_back();
    // Frames that had to wait for the first reference come first, each with what the mapper made of it.
    std::vector<TrackedFrameConstPtr> reported = result.late;
    reported.push_back(result.tracked());
    for (const TrackedFrameConstPtr& tracked : reported) {
      Step& step = steps.at(tracked->frame->sequence);
      if (tracked->tracked() && !step.used) step.used = tracked->reference;  // at first: it may be tracked again later
    }
    std::size_t taken_in = 0;
    for (const MapperOutput& output : result.mapping) {
      if (!output.refinement) ++taken_in;                  // that is what the last one has caused
      if (!output.reference || output.inserted) continue;  // drafts are for live runs
      steps.at(reported.at(taken_in - 1)->frame->sequence).emitted = output.reference->id;
    }
  }
  return steps;
}

class ReferenceDelay : public testing::TestWithParam<int> {};

TEST_P(ReferenceDelay, ReferencesAreUsedExactlyThatManyFramesLater) {
  const int delay = GetParam();
  const std::vector<Step> steps = runSteps(delay);
  int checked = 0;
  bool map_runs = false;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (!steps[k].emitted) continue;
    if (!std::exchange(map_runs, true)) continue;  // the first one is for the frames that waited for it
    const std::size_t due = k + 1 + static_cast<std::size_t>(delay);
    for (std::size_t i = 0; i < std::min(due, steps.size()); ++i) {
      EXPECT_FALSE(steps[i].used && *steps[i].used == *steps[k].emitted) << "of frame " << k << " used at " << i;
    }
    if (due < steps.size() && steps[due].used) {
      EXPECT_TRUE(*steps[due].used == *steps[k].emitted) << "of frame " << k << " not used at " << due;
      ++checked;
    }
  }
  EXPECT_GE(checked, 2);
}

INSTANTIATE_TEST_SUITE_P(Frames, ReferenceDelay, testing::Values(0, 4));

}  // namespace
}  // namespace mba_vo::reference_delay_test
