#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "support/rendered_sequence.h"

namespace mba_vo::test {

inline constexpr double kWalkExposure = 0.03;  // [s] of 37 ms between frames
inline constexpr int kWalkFrames = 120;

struct Walk {
  std::vector<FrameConstPtr> frames;
  std::vector<SE3> truth;  // T_world_camera of each
};

/// Through the room of seed 1, very blurred.
inline const Walk& walk() {
  static const Walk walk = [] {
    SimulationConfig config = sequenceConfig(kWalkExposure);
    config.trajectory_seed = 3;
    config.path_length = 2.5;
    const RenderedSequence rendered = renderFrames(config, 0, kWalkFrames);
    Walk made{toFrames(rendered, false, kWalkExposure), {}};
    for (const SimulatedFrame& frame : rendered.frames) made.truth.push_back(frame.T_world_mid);
    return made;
  }();
  return walk;
}

/// The same, and then the same backwards: a blurred image looks the same either way.
inline const Walk& walkThereAndBack() {
  static const Walk walk = [] {
    const Walk& there = test::walk();
    const std::int64_t first_ns = there.frames[0]->mid_exposure_ns;
    const std::int64_t interval_ns = there.frames[1]->mid_exposure_ns - first_ns;
    Walk made;
    for (int i = 0; i < 2 * kWalkFrames - 1; ++i) {
      const auto at = static_cast<std::size_t>(i < kWalkFrames ? i : 2 * kWalkFrames - 2 - i);
      auto frame = std::make_shared<Frame>(*there.frames[at]);
      frame->sequence = static_cast<std::uint64_t>(i);
      frame->stamp_ns = frame->mid_exposure_ns = first_ns + i * interval_ns;
      made.frames.push_back(frame);
      made.truth.push_back(there.truth[at]);
    }
    return made;
  }();
  return walk;
}

}  // namespace mba_vo::test
