#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "mba_vo/geometry/calibration_correction.h"
#include "mba_vo/geometry/exposure_trajectory.h"
#include "mba_vo/image/image_pyramid.h"
#include "mba_vo/tracking/reference.h"
#include "mba_vo/window/depth_agreement.h"

namespace mba_vo {

struct CalibrationSystem;

/// Options of the windowed photometric bundle adjustment.
struct WindowConfig {
  int max_keyframes = 30;
  int min_keyframes = 7;
  int max_residuals = 5000;
  int max_residuals_blurred = 20000;
  double long_blur_px = 25.0;
  int max_points = 1000;
  int max_iterations = 4;
  double min_relative_decrease = 0.01;
  double huber_threshold = 9.0;
  bool reblur_targets = true;
  double gradient_constant = 50.0;
  double sample_spacing_px = 1.25;
  int max_samples = 64;
  double brightness_gain_sigma = 0.5;
  double brightness_offset_sigma = 30.0;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("max_keyframes", c.max_keyframes, 3, 100, "keyframes in the window, at most");
    v("min_keyframes", c.min_keyframes, 3, 100, "keyframes in the window, however many residuals there are");
    v("max_residuals", c.max_residuals, 0, 1000000, "residuals in a window of more than min_keyframes");
    v("max_residuals_blurred", c.max_residuals_blurred, 0, 1000000,
      "the same, where one of the newest keyframes has a long blur");
    v("long_blur_px", c.long_blur_px, 0.0, 1000.0, "blur of a keyframe that counts as long [px]");
    v("max_points", c.max_points, 100, 20000,
      "active points in the window; fewer where keyframes come faster than it is optimised");
    v("max_iterations", c.max_iterations, 1, 50, "iterations of the bundle adjustment per keyframe");
    v("min_relative_decrease", c.min_relative_decrease, 0.0, 1.0,
      "decrease of the cost, relative to it, below which no further iteration follows");
    v("huber_threshold", c.huber_threshold, 0.1, 255.0, "largest Huber threshold of the residual [grey levels]");
    v("reblur_targets", c.reblur_targets, "compare the re-blurred host patch with the target's original image");
    v("gradient_constant", c.gradient_constant, 0.0, 1000.0,
      "c of the residual weight c^2 / (c^2 + gradient^2), 0 = no weight [grey levels / px]");
    v("sample_spacing_px", c.sample_spacing_px, 0.1, 10.0, "spacing of samples along the blur path [px]");
    v("max_samples", c.max_samples, 1, 256, "most samples along the blur path");
    v("brightness_gain_sigma", c.brightness_gain_sigma, 1e-6, 10.0,
      "weak prior on a keyframe's log gain a, relative to none");
    v("brightness_offset_sigma", c.brightness_offset_sigma, 1e-4, 1000.0,
      "weak prior on a keyframe's brightness offset b, relative to none [grey levels]");
  }
};

using PointId = std::uint64_t;

/// A keyframe as it enters the window.
struct WindowKeyframe {
  KeyframeId id = 0;
  std::shared_ptr<const ImagePyramid> sharp;     // used as host image
  std::shared_ptr<const ImagePyramid> original;  // used as target image
  SE3 T_map_keyframe;
  Vector6 xi = Vector6::Zero();        // motion within its exposure, camera frame
  Vector6 image_xi = Vector6::Zero();  // motion blur left in `sharp`, 0 = none [m, rad]
  AffineBrightness brightness;
  BodyMotion motion{};                 // while the rows of a rolling shutter are read
  double blur_length_px = 0.0;         // median over the points it sees
  CalibrationCorrection correction{};  // of the calibration, that the images were made with
};

/// What the alignment of a blurred image with the points of a window finds.
struct KeyframeMotion {
  SE3 T_map_keyframe;
  AffineBrightness brightness;
  Vector6 xi = Vector6::Zero();  // motion within its exposure, camera frame [m, rad]
};

/// A point that may enter the window.
struct NewPoint {
  KeyframeId host = 0;
  Eigen::Vector2d pixel;       // in the host
  double inverse_depth = 0.0;  // where its refinement begins; what is not positive is refused
  double sigma = 0.0;          // how far it may be off [1/m]: keyframes that would show that far away have to wait
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  MeasuredDepth measured{};
};

/// State of one active point, for callers.
struct WindowPoint {
  PointId id = 0;
  KeyframeId host = 0;
  Eigen::Vector2d pixel;  // in the host
  double inverse_depth = 0.0;
  double variance = 0.0;  // of the inverse depth, from the Hessian, for unit variance of a residual [1/m^2]
  int good_residuals = 0;
  double relative_baseline = 0.0;  // largest translation to a target over depth
  bool visible_in_newest = false;  // good residual in the newest keyframe (or hosted by it)
};

/// Costs count outliers with their threshold. The thresholds follow the residuals, so they may differ between the two.
struct WindowSummary {
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int iterations = 0;
  int residuals = 0;  // inlier (point, target) pairs
  double rms = 0.0;   // per pixel [grey levels]
  DepthAgreement depths;
};

/// Windowed photometric bundle adjustment (DSO, Sec. 2-3): keyframe poses, affine brightness and inverse depths, with
/// first-estimates Jacobians, Schur complement, CHOLMOD, and marginalisation of old keyframes into a quadratic prior.
class Window {
 public:
  /// Results are bit-identical however many threads TBB uses: sums have a fixed order.
  explicit Window(const WindowConfig& config);
  ~Window();

  void addKeyframe(const WindowKeyframe& keyframe);
  /// The image of a host has become sharp. What depended on the old one is made anew by `optimize`.
  void replaceImage(KeyframeId id, std::shared_ptr<const ImagePyramid> sharp);
  /// The exposure of a keyframe, which nobody told, is known better now [s]. `image_is_blurred`: by it, as a host.
  void setExposure(KeyframeId id, double exposure, bool image_is_blurred);
  /// How a keyframe moves is known better now [m/s, rad/s, body frame].
  void setMotion(KeyframeId id, const BodyMotion& motion);
  /// Whether the host with that image instead of its own would explain the other keyframes no worse, by these points
  /// seen from it; false if it cannot be told. Changes nothing.
  bool explainsAsWell(KeyframeId host, const std::shared_ptr<const ImagePyramid>& sharp,
                      const std::vector<ReferencePoint>& points) const;
  /// Adds a point with residuals to every other keyframe of the window in which it is visible.
  /// Measured depths give the window their scale; without any it keeps that of its first keyframes.
  PointId addPoint(KeyframeId host, const Eigen::Vector2d& pixel, double inverse_depth,
                   const MeasuredDepth& measured = {});
  /// Refines the inverse depths of new points against all keyframes, poses fixed, side by side, and adds those on which
  /// enough keyframes agree and whose depth is well determined. Returns for each whether it was added.
  std::vector<bool> activatePoints(const std::vector<NewPoint>& points);
  /// Sets the slopes of the surface at points(), in their order, see PointState; nullopt: it stays.
  void setSlopes(const std::vector<std::optional<Eigen::Vector2d>>& slopes);
  /// Adds the residuals of all existing points into a keyframe just added.
  void addResidualsTo(KeyframeId target);

  /// Estimates the newest keyframe, which hosts no points yet, by the points it sees: its pose and brightness and the
  /// motion within its exposure, which `optimize` does not change. Returns whether anything has changed.
  bool alignNewest();
  /// Estimates the same of a frame that is no keyframe, by all points, from what it says of itself. nullopt if it is
  /// sharp, sees too few of them, or nothing better is found.
  std::optional<KeyframeMotion> align(const WindowKeyframe& frame) const;

  /// Levenberg-Marquardt on all states; re-classifies residuals as inliers and outliers; drops points left without any.
  WindowSummary optimize(int max_iterations);
  /// The same in pieces: `iterate` does one step and says whether another is wanted; the end may come at any time.
  /// Nothing may be added, replaced or marginalised meanwhile.
  void beginOptimization(int max_iterations);
  bool iterate();
  WindowSummary endOptimization();

  /// The correction of the calibration that all images should have been made with; the window makes up for the
  /// difference. What was marginalised follows; while that is little, all of it is forgotten with the first correction
  /// of the geometry, as what was seen by a wrong one is wrong by more than small steps mend.
  void setCorrection(const CalibrationCorrection& correction);
  /// No other correction is expected: what is marginalised from now on need not follow one.
  void settleCorrection();
  /// Moves the velocities of keyframes whose rows were read one after the other to where the residuals want them.
  /// Returns what else they say about how the images came about: errors left in the calibration.
  CalibrationSystem refineRowMotions();

  /// Keyframes to marginalise now so that the window has room for a new one, see chooseKeyframesToMarginalize.
  std::vector<KeyframeId> keyframesToMarginalize() const;
  /// Moves points that neither of the two newest keyframes sees any more into the prior, if they are well enough
  /// observed, else drops them. `marginalize` does this too.
  void marginalizePoints();
  /// Moves the keyframe, and the points it hosts that are well enough observed, into the prior; drops the rest.
  void marginalize(KeyframeId keyframe);

  std::vector<KeyframeId> keyframes() const;  // by age, oldest first
  SE3 T_map_keyframe(KeyframeId id) const;
  /// Of the keyframe's images, as is known now, apart from radial distortion.
  PinholeCamera camera(KeyframeId id) const;
  BodyMotion motion(KeyframeId id) const;
  /// The motion blur left in the image that the keyframe has as a host, 0 = none [m, rad].
  Vector6 imageMotion(KeyframeId id) const;
  AffineBrightness brightness(KeyframeId id) const;
  std::vector<WindowPoint> points() const;
  std::vector<double> inverseDepths() const;  // of these [1/m]
  int pointCount() const;
  int residualCount() const;       // good or not
  int evaluatedResiduals() const;  // by the last piece of an optimisation: those that have not settled

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mba_vo
