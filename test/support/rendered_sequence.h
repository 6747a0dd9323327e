#pragma once

#include <optional>
#include <vector>

#include "mba_vo/image/frame_builder.h"
#include "simulation/test_scenes.h"
#include "support/test_frames.h"

namespace mba_vo::test {

/// Frames of a camera shaken in the room of seed 1, with sharp twins.
struct RenderedSequence {
  CameraCalibration calibration;
  std::vector<SimulatedFrame> frames;
};

inline SimulationConfig sequenceConfig(double exposure) {
  SimulationConfig config;
  config.resize(376, 240);
  config.exposure = exposure;
  config.max_step = 1.0;  // fine enough for an odometry, in half the time
  config.sharp = true;
  return config;
}

inline RenderedSequence renderFrames(const SimulationConfig& config, int first, int count) {
  const Simulator simulator(config, sharedRoom());
  const FrameCache cache = testFrames(config);
  RenderedSequence sequence{simulator.calibration(), {}};
  for (int i = first; i < first + count; ++i) sequence.frames.push_back(testFrame(simulator, i, cache));
  return sequence;
}

/// The sequence as the odometry gets it. `exposure` is what it is told.
inline std::vector<FrameConstPtr> toFrames(const RenderedSequence& sequence, bool sharp, std::optional<double> exposure,
                                           int binning = 1) {
  FrameBuilderConfig config;
  config.binning = binning;
  const FrameBuilder builder(sequence.calibration, {}, config);
  std::vector<FrameConstPtr> frames;
  for (const SimulatedFrame& f : sequence.frames) {
    frames.push_back(builder.build(sharp ? f.sharp : f.blurred, f.id, f.mid_exposure_ns, f.mid_exposure_ns, exposure));
  }
  return frames;
}

}  // namespace mba_vo::test
