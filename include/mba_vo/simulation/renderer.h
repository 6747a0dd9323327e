#pragma once

#include <functional>
#include <memory>

#include <opencv2/core.hpp>

#include "mba_vo/geometry/se3.h"
#include "mba_vo/simulation/ray_table.h"
#include "mba_vo/simulation/scene.h"
#include "mba_vo/simulation/view.h"

namespace mba_vo {

/// T_world_camera at time t [s].
using PoseFunction = std::function<SE3(double t)>;

struct RendererConfig {
  double max_step = 0.5;  // largest image motion between two sub-frames [px]
  double row_time = 0.0;  // [s]; row r is exposed around t_mid + (r - (height - 1) / 2) row_time
};

/// Integrates the light that reaches each pixel of a moving camera while the shutter is open.
class Renderer {
 public:
  Renderer(std::shared_ptr<const Scene> scene, const CameraCalibration& calibration, const RendererConfig& config);

  /// Mean light over the exposure [grey levels], before response, vignette and noise. `exposure` 0 = an instant.
  cv::Mat1f integrate(const PoseFunction& pose, double t_mid, double exposure) const;

  /// z of what the centre of each pixel sees at the middle of its exposure [m].
  cv::Mat1f depth(const PoseFunction& pose, double t_mid) const;

  /// Sub-frames that keep the image motion from one to the next below `max_step` everywhere.
  int subFrames(const PoseFunction& pose, double t_mid, double exposure) const;

 private:
  double rowDelay(int row) const;

  /// What any row may see.
  SurfaceList inSight(const PoseFunction& pose, double t_mid, double exposure) const;

  std::shared_ptr<const Scene> scene_;
  SurfaceList surfaces_;  // of the scene
  RendererConfig config_;
  RayTable rays_;
};

}  // namespace mba_vo
