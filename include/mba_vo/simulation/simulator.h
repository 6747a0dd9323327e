#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "mba_vo/geometry/pinhole_camera.h"
#include "mba_vo/simulation/exposure_programme.h"
#include "mba_vo/simulation/renderer.h"
#include "mba_vo/simulation/sensor.h"
#include "mba_vo/simulation/sequence_sink.h"
#include "mba_vo/simulation/simulation_config.h"

namespace mba_vo {

/// T_world_camera over the time since the middle of the first exposure, and how long the frames go on.
struct CameraMotion {
  PoseFunction pose;
  double span;  // from the first frame to the last instant for one [s]
};

/// A camera carried through a procedural room, by an invented hand or along a recorded motion. Frames may be rendered
/// in any order.
class Simulator {
 public:
  /// Throws std::invalid_argument naming a value that is not allowed, and as MotionPiece does.
  explicit Simulator(const SimulationConfig& config);
  /// In a room of one's own.
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
  const ExposureProgramme& exposures() const { return exposures_; }

  /// Throws std::out_of_range for a frame that is not in the sequence.
  SimulatedFrame render(int index) const;
  /// Depths of a frame at mid-exposure [m].
  cv::Mat1f renderDepth(int index) const;

  /// All of a frame but its images.
  SimulatedFrame groundTruth(int index) const;

  /// A frame seen along any motion `pose` (T_world_camera at t [s]), as bright as the configuration's exposure makes
  /// it. `id` chooses the noise.
  SimulatedFrame renderExposure(const PoseFunction& pose, double t_mid, double exposure, std::uint64_t id = 0) const;

 private:
  struct Stage {
    CameraMotion motion;
    std::shared_ptr<const Scene> scene;
  };
  static Stage makeStage(const SimulationConfig& config, std::shared_ptr<const Scene> scene);
  Simulator(const SimulationConfig& config, Stage stage);

  SimulatedFrame describeExposure(const PoseFunction& pose, double t_mid, double exposure, std::uint64_t id) const;
  void renderImages(const PoseFunction& pose, double t_mid, const SensorConfig& sensor, SimulatedFrame& frame) const;
  SensorConfig sensor(double brightness, double gain) const;

  SimulationConfig config_;
  CameraMotion motion_;
  ExposureProgramme exposures_;
  Renderer renderer_;
};

/// Mean over the image of the motion from start to end of points 2 m before the camera at mid-exposure [px].
double blurAtTwoMetres(const PinholeCamera& camera, const SimulatedFrame& frame);

/// Renders all frames into `sink`, taking those already in `cache_folder` from there; "" = no cache.
/// `progress` is told the number of finished frames; returning false stops before the next one.
void renderSequence(const Simulator& simulator, SequenceSink& sink, const std::string& cache_folder,
                    const std::function<bool(int)>& progress = {});

}  // namespace mba_vo
