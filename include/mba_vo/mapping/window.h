#pragma once

#include <map>
#include <memory>
#include <vector>

#include "mba_vo/geometry/exposure_trajectory.h"
#include "mba_vo/image/image_pyramid.h"
#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// Options of the windowed photometric bundle adjustment.
struct WindowConfig {
  int max_keyframes = 7;
  int max_points = 2000;
  int max_iterations = 6;
  double huber_threshold = 9.0;
  bool reblur_targets = true;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("max_keyframes", c.max_keyframes, 3, 20, "keyframes in the window");
    v("max_points", c.max_points, 100, 20000, "active points in the window");
    v("max_iterations", c.max_iterations, 1, 50, "iterations of the bundle adjustment per keyframe");
    v("huber_threshold", c.huber_threshold, 0.1, 255.0, "Huber threshold of the residual [grey levels]");
    v("reblur_targets", c.reblur_targets, "compare the re-blurred host patch with the target's original image");
  }
};

using PointId = std::uint64_t;

/// A keyframe as it enters the window.
struct WindowKeyframe {
  KeyframeId id = 0;
  std::shared_ptr<const ImagePyramid> sharp;     // used as host image
  std::shared_ptr<const ImagePyramid> original;  // used as target image
  SE3 T_map_keyframe;
  Vector6 xi = Vector6::Zero();                  // motion within its exposure, camera frame
  AffineBrightness brightness;
};

/// State of one active point, for callers.
struct WindowPoint {
  PointId id = 0;
  KeyframeId host = 0;
  Eigen::Vector2d pixel;      // in the host
  double inverse_depth = 0.0;
  double variance = 0.0;      // of the inverse depth, from the Hessian
  int good_residuals = 0;
  double relative_baseline = 0.0;  // largest translation to a target over depth
};

struct WindowSummary {
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int iterations = 0;
  int residuals = 0;  // inlier (point, target) pairs
  double rms = 0.0;   // per pixel [grey levels]
};

/// Windowed photometric bundle adjustment (DSO, Sec. 2-3): keyframe poses, affine brightness and inverse depths, with
/// first-estimates Jacobians, Schur complement, CHOLMOD, and marginalisation of old keyframes into a quadratic prior.
class Window {
 public:
  Window(const WindowConfig& config, bool deterministic);
  ~Window();

  void addKeyframe(const WindowKeyframe& keyframe);
  /// Adds a point with residuals to every other keyframe of the window in which it is visible.
  PointId addPoint(KeyframeId host, const Eigen::Vector2d& pixel, double inverse_depth);
  /// Adds the residuals of all existing points into a keyframe just added.
  void addResidualsTo(KeyframeId target);

  /// Levenberg-Marquardt on all states; re-classifies residuals as inliers and outliers; drops points left without any.
  WindowSummary optimize(int max_iterations);

  /// Keyframes to marginalise now so that the window keeps its size (at most max_keyframes - 1 remain before a new one).
  std::vector<KeyframeId> keyframesToMarginalize() const;
  /// Moves the keyframe, and the points it hosts that are well enough observed, into the prior; drops the rest.
  void marginalize(KeyframeId keyframe);

  std::vector<KeyframeId> keyframes() const;  // by age, oldest first
  SE3 T_map_keyframe(KeyframeId id) const;
  AffineBrightness brightness(KeyframeId id) const;
  std::vector<WindowPoint> points() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mba_vo
