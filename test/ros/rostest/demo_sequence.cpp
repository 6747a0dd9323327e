#include "demo_sequence.h"

#include <filesystem>

#include "mba_vo/ros/bag_sink.h"
#include "mba_vo/simulation/simulator.h"

namespace mba_vo {

DemoSequence makeDemoSequence(const std::string& folder) {
  SimulationConfig config;
  config.resize(376, 240);
  config.rate = 20.0;
  config.exposure = 0.010;
  config.duration = 5.0;
  config.shake = 0.5;
  const Simulator simulator(config);

  std::filesystem::create_directories(folder);
  DemoSequence sequence;
  sequence.bag = folder + "/demo.bag";
  sequence.exposure = config.exposure;
  for (int i = 0; i < simulator.frames(); ++i) {
    const SimulatedFrame frame = simulator.groundTruth(i);
    sequence.stamps.push_back(frame.mid_exposure_ns);
    PoseRecord record;
    record.time = 1e-9 * static_cast<double>(frame.mid_exposure_ns);
    record.T_world_camera = frame.T_world_mid;
    sequence.groundtruth.push_back(record);
  }
  renderSequence(simulator, *makeBagSink(sequence.bag, simulator.calibration()), folder + "/cache");
  return sequence;
}

}  // namespace mba_vo
