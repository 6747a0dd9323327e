#pragma once

#include <vector>

#include "mba_vo/geometry/se3.h"
#include "mba_vo/simulation/scene.h"

namespace mba_vo {

struct HandHeldMotionConfig {
  int seed = 1;
  double duration = 10.0;    // [s]
  double shake = 1.0;        // 1: a constant-velocity guess at 27 Hz errs by 0.5 deg in the median, 1.1 deg at 90 %
  double path_length = 0.0;  // [m]; 0 = 0.4 m/s
};

/// Smooth random motion of a camera in a hand: a slow walk and gaze, and shaking that comes in bursts.
/// Every component is a finite sum of sinusoids, so all derivatives exist and the walk cannot leave the free space.
class HandHeldMotion {
 public:
  /// Throws std::invalid_argument if `path_length` cannot be reached.
  HandHeldMotion(const HandHeldMotionConfig& config, const FreeSpace& space);

  /// T_world_camera at t [s] after the first frame.
  SE3 pose(double t) const;

 private:
  struct Wave {
    double amplitude, frequency, phase;  // frequency [rad/s]
  };
  using Waves = std::vector<Wave>;
  static double sum(const Waves& waves, double t);

  void calibrateTempo(const HandHeldMotionConfig& config);
  void calibrateShake(const HandHeldMotionConfig& config);
  double pathLength(double duration) const;

  FreeSpace space_;
  Waves walk_[3];       // offset from the middle of the free space, in units of its half size
  Waves gaze_[3];       // yaw, pitch, roll [rad]
  Waves sway_[3];       // translation of the hand for unit shake [m]
  Waves tremble_[3];    // rotation of the hand for unit shake [rad]
  Waves burst_;         // strength of the shaking
  double yaw_ = 0.0;    // middle of the gaze [rad]
  double tempo_ = 1.0;  // of walk and gaze
  double sway_scale_ = 0.0;
  double tremble_scale_ = 0.0;
};

/// Rotation error of the guess that the motion between two frames repeats itself, for each frame but two [deg].
std::vector<double> constantVelocityErrors(const std::vector<SE3>& T_world_camera);

}  // namespace mba_vo
