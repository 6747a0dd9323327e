#pragma once

#include <algorithm>
#include <cstdint>

#include "mba_vo/simulation/simulator.h"

namespace mba_vo {

/// The simulator's camera, but for some time it only turns, and walks from then on: the time of its translation stands
/// still at first and gathers way within `kOnset`.
class TurningFirst {
 public:
  static constexpr double kOnset = 0.5;  // [s]

  TurningFirst(const Simulator& simulator, double seconds) : simulator_(simulator), seconds_(seconds) {}

  SE3 pose(double t) const {  // T_world_camera
    return {simulator_.pose(t).rotation(), simulator_.pose(walkingTime(t)).translation()};
  }

  SimulatedFrame render(int index) const {
    return simulator_.renderExposure([this](double t) { return pose(t); }, simulator_.time(index),
                                     simulator_.config().exposure, static_cast<std::uint64_t>(index));
  }

 private:
  double walkingTime(double t) const {
    const double since = std::max(0.0, t - seconds_);
    return seconds_ + (since < kOnset ? 0.5 * since * since / kOnset : since - 0.5 * kOnset);
  }

  const Simulator& simulator_;
  double seconds_;
};

}  // namespace mba_vo
