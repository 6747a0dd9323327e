#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "mba_vo/blur/moment_products.h"
#include "mba_vo/geometry/calibration_correction.h"
#include "mba_vo/geometry/exposure_trajectory.h"
#include "mba_vo/image/image_pyramid.h"
#include "mba_vo/solver/marginalization_prior.h"
#include "mba_vo/window/window.h"

namespace mba_vo {

/// Pixels of one residual: the pattern PatchPattern::spread8().
inline constexpr int kResidualPixels = kSparsePixels;

/// A keyframe's state: T_map_keyframe = T_linear Exp(delta[0..5]), a = a_linear + delta[6], b = b_linear + delta[7].
/// Jacobians are taken at the linearisation point. It follows the estimate until the keyframe is part of the
/// marginalisation prior; from then on it stays ("first estimates"), so that the prior and the residuals agree about
/// which directions cannot be observed.
struct KeyframeState {
  KeyframeState() = default;
  explicit KeyframeState(const WindowKeyframe& entering);

  KeyframeId id = 0;
  std::shared_ptr<const ImagePyramid> sharp;
  std::shared_ptr<const ImagePyramid> original;
  Vector6 xi = Vector6::Zero();
  Vector6 image_xi = Vector6::Zero();  // motion blur left in `sharp`, 0 = none [m, rad]
  Vector6 velocity = Vector6::Zero();  // while it is exposed, and the rows of a rolling shutter are read [m/s, rad/s]
  Vector6 expected_velocity = Vector6::Zero();  // by the motion before and after
  Vector6 acceleration = Vector6::Zero();       // likewise [m/s^2, rad/s^2]
  CalibrationCorrection correction;             // of the calibration, that the images were made with
  CalibrationCorrection lacking;                // what is to be added to it, as is known now
  SE3 T_linear;
  AffineBrightness brightness_linear;
  Vector8 delta = Vector8::Zero();
  double blur_length_px = 0.0;  // as it was tracked
  double outlier_energy = 0.0;  // a residual into this keyframe with more energy than this is an outlier [spread^2]
  float huber_threshold = std::numeric_limits<float>::infinity();  // of residuals into it, if below the options'
  float precision = 1.0F;  // of residuals into it: one over their squared spread [1 / grey level^2]

  double exposure() const { return velocity.isZero(0.0) ? 0.0 : xi.norm() / velocity.norm(); }  // [s]
  BodyMotion motion() const { return {velocity, acceleration}; }
  /// Of both images, as is known now, apart from radial distortion.
  PinholeCamera camera() const {
    return withCorrection(sharp->level(0).camera, pinholePart(lacking, sharp->level(0).camera));
  }
  double readoutTime() const;  // from the first row to the last, as is known now [s]
  /// Sets xi, and what is known by it.
  void setMotion(const Vector6& motion);
  /// Sets the velocity, and with it the motion within the exposure.
  void setVelocity(const Vector6& moving);
  SE3 T_map_keyframe() const { return T_linear * SE3::exp(delta.head<6>()); }
  AffineBrightness brightness() const { return {brightness_linear.a + delta(6), brightness_linear.b + delta(7)}; }
};

/// Throws std::invalid_argument if the keyframe lacks an image that is needed.
void checkImages(const WindowKeyframe& keyframe, bool reblur_targets);

/// Energy of a residual whose patch left one of the images, or that they show in sizes too different.
inline constexpr float kNoEnergy = std::numeric_limits<float>::quiet_NaN();

/// One point seen in one target keyframe: eight integer pixels of the target image around the point's projection.
struct PatchResidual {
  int target = 0;  // index of the keyframe in the window
  bool has_pixels = false;
  Eigen::Vector2i centre = Eigen::Vector2i::Zero();
  std::array<float, kResidualPixels> intensity{};  // of the target [grey levels]
  std::array<float, kResidualPixels> weight{};     // from the target's gradient, in (0, 1]
  float energy = kNoEnergy;                        // at the current state [spread^2]
  float trial_energy = kNoEnergy;                  // at the state being tried
  float misfit = kNoEnergy;                        // with the options' Huber threshold [grey levels^2]
  float drift = 0.0F;  // distance of the projection from the pixel set, at the state tried [px]
  int bad_rounds = 0;  // optimisations in a row that ended with this residual out of use
};

struct PointState {
  PointId id = 0;
  int host = 0;  // index of the keyframe in the window
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double inverse_depth = 0.0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  // d inverse depth / d host pixel of the surface [1/(m px)]
  MeasuredDepth measured;                           // by a depth image, if at all
  double information = 0.0;  // of the inverse depth: its entry of the Hessian at the current state
  std::vector<PatchResidual> residuals;
};

/// All that the window estimates, and what it remembers of what it no longer estimates.
struct WindowState {
  std::vector<KeyframeState> keyframes;  // by age, oldest first
  std::vector<PointState> points;
  MarginalizationPrior prior;
  bool correction_settled = false;  // what is marginalised need not follow corrections of the calibration

  int size() const { return static_cast<int>(keyframes.size()); }
  KeyframeState& keyframe(int i) { return keyframes[static_cast<std::size_t>(i)]; }
  const KeyframeState& keyframe(int i) const { return keyframes[static_cast<std::size_t>(i)]; }

  /// Index of a keyframe; throws std::invalid_argument naming the id if it is not in the window.
  int indexOf(KeyframeId id) const;
  /// The deviations of all keyframes from their linearisation points, one after the other.
  Eigen::VectorXd deltas() const;
  /// Moves the linearisation points of keyframes outside the prior to their current state.
  void relinearize();
  /// The image that keyframe `i` has as a host is sharp now.
  void replaceImage(int i, std::shared_ptr<const ImagePyramid> sharp);
  /// The exposure of keyframe `i` is known better now, and with it the motion within it.
  void setExposure(int i, double exposure, bool image_is_blurred);
  /// How keyframe `i` moves is known better now; with a rolling shutter, what is expected of it.
  void setMotion(int i, const BodyMotion& motion);
  /// Removes keyframe `i`, its points and all residuals into it. The prior must not depend on it any more.
  void removeKeyframe(int i);

  /// What the targets show of the points of host `i`, which were blurred as the host was, has to be read again.
  void readAgain(int i);

  bool isGood(const PatchResidual& residual) const {
    return residual.energy <= keyframe(residual.target).outlier_energy;  // false for kNoEnergy
  }
  int goodResiduals(const PointState& point) const;
  /// Then the scale is theirs.
  bool hasMeasuredDepths() const;
  /// Of the residuals into keyframes, their mean; 1 without any [1 / grey level^2].
  double meanPrecision() const;
};

}  // namespace mba_vo
