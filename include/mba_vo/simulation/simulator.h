#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "mba_vo/geometry/pinhole_camera.h"
#include "mba_vo/simulation/hand_held_motion.h"
#include "mba_vo/simulation/renderer.h"
#include "mba_vo/simulation/sequence_sink.h"
#include "mba_vo/simulation/simulation_config.h"

namespace mba_vo {

/// A camera carried through a procedural room. Frames may be rendered in any order.
class Simulator {
 public:
  /// Throws std::invalid_argument naming a value that is not allowed.
  explicit Simulator(const SimulationConfig& config);
  Simulator(const SimulationConfig& config, std::shared_ptr<const Scene> scene);

  const SimulationConfig& config() const { return config_; }
  PinholeCamera camera() const { return config_.camera(); }  // without the distortion
  CameraCalibration calibration() const { return config_.calibration(); }
  const Renderer& renderer() const { return renderer_; }

  int frames() const;
  /// Mid-exposure time of a frame on the trajectory's clock, which starts at the first frame [s].
  double time(int index) const { return index / config_.rate; }
  std::int64_t stampNs(int index) const;                // mid-exposure [ns]
  SE3 pose(double t) const { return motion_.pose(t); }  // T_world_camera

  /// Throws std::out_of_range for a frame that is not in the sequence.
  SimulatedFrame render(int index) const;
  /// Depths of a frame at mid-exposure [m].
  cv::Mat1f renderDepth(int index) const;

  /// All of a frame but its images.
  SimulatedFrame groundTruth(int index) const;

  /// A frame seen along any motion `pose` (T_world_camera at t [s]). `id` chooses the noise.
  SimulatedFrame renderExposure(const PoseFunction& pose, double t_mid, double exposure, std::uint64_t id = 0) const;

 private:
  SimulatedFrame describeExposure(const PoseFunction& pose, double t_mid, double exposure, std::uint64_t id) const;
  void renderImages(const PoseFunction& pose, double t_mid, SimulatedFrame& frame) const;

  SimulationConfig config_;
  HandHeldMotion motion_;
  Renderer renderer_;
};

/// Mean over the image of the motion from start to end of points 2 m before the camera at mid-exposure [px].
double blurAtTwoMetres(const PinholeCamera& camera, const SimulatedFrame& frame);

/// Renders all frames into `sink`, taking those already in `cache_folder` from there; "" = no cache.
/// `progress` is told the number of finished frames; returning false stops before the next one.
void renderSequence(const Simulator& simulator, SequenceSink& sink, const std::string& cache_folder,
                    const std::function<bool(int)>& progress = {});

}  // namespace mba_vo
