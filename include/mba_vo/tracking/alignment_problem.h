#pragma once

#include <array>
#include <optional>
#include <vector>

#include "mba_vo/blur/reblur.h"
#include "mba_vo/image/frame.h"
#include "mba_vo/solver/normal_equations.h"
#include "mba_vo/solver/robust_loss.h"
#include "mba_vo/tracking/motion_prior.h"
#include "mba_vo/tracking/quadratic_model.h"
#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// What alignment estimates: mid pose, motion within the exposure, brightness of the frame relative to the reference
/// (frame = exp(a) reference + b).
struct AlignmentState {
  SE3 T_reference_mid;
  Vector6 xi = Vector6::Zero();
  double a = 0.0;
  double b = 0.0;
  Vector6 bend = Vector6::Zero();  // acceleration times the square of the exposure; its turn may be estimated
  double log_exposure = 0.0;       // of the exposure that xi and the bend belong to, over that of the options
};

struct AlignmentOptions {
  double huber_threshold = 9.0;  // [grey levels] also that of an inlier
  double sample_spacing_px = 1.25;
  int max_samples = 64;
  bool estimate_xi = true;          // false: the exposure is instantaneous, xi stays zero
  bool estimate_turn_bend = false;  // of a rolling shutter, whose rows tell it
  bool estimate_exposure = false;   // likewise: rows tell the velocity, so the blur tells the exposure
  bool rotation_only = false;       // neither position nor linear velocity is estimated
  bool with_covariance = false;     // keep what it needs
  double exposure = 1.0;            // [s] that xi belongs to; matters to a rolling shutter alone
  double residual_sigma = 20.0;  // [grey levels] largest weight of the priors against the pixels, correlation included
  double depth_noise = 3.0;      // [grey levels] pixel noise that the effect of depth uncertainty is compared with
};

/// Quadratic priors; those on xi and the bend are for the exposure of the options.
struct AlignmentPrior {
  SE3 T_reference_mid;
  Vector6 pose_information = Vector6::Zero();
  Vector6 xi = Vector6::Zero();
  Vector6 xi_information = Vector6::Zero();
  Eigen::Vector3d turn_bend = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_bend_information = Eigen::Vector3d::Zero();
  double log_exposure_information = 0.0;
};

/// What the residuals say about the fit.
struct AlignmentStatistics {
  int patches = 0;               // with at least one valid pixel
  int pixels = 0;                // valid
  double inlier_fraction = 0.0;  // pixels below the options' Huber threshold, of all pixels that were to be used
  double rms = 0.0;              // of the inliers [grey levels]
  double weighted_rms = 0.0;     // of all valid pixels, Huber-weighted [grey levels]
};

/// Re-blurred patches of the reference against patches of the frame on one pyramid level (Eq. 7 of the paper): the
/// problem that `minimize` solves. States: (delta of T_mid, epsilon of xi, a, b, turning part of the bend, log exposure
/// at the velocity that xi means).
class AlignmentProblem {
 public:
  static constexpr int kStates = 18;
  static constexpr int kLogExposure = 17;  // its place among them
  using Step = Eigen::Matrix<double, kStates, 1>;

  AlignmentProblem(const Reference& reference, const std::vector<int>& points, const Frame& frame, int level,
                   const PatchPattern& pattern, const AlignmentOptions& options,
                   const std::optional<AlignmentPrior>& prior, const AlignmentState& initial);

  struct Equations : NormalEquations<kStates> {
    AlignmentStatistics statistics;
    std::vector<QuadraticModel::PatchGradient> patch_gradients;  // empty unless the covariance was asked for
    double log_exposure_prior = 0.0;                             // what its prior adds to the Hessian
    Step prior_scatter = Step::Zero();  // variance of the gradients of the priors, whose states are independent

    /// Covariance of the state at the minimum, H^-1 S H^-1 with the scatter S of the gradients of patches and priors,
    /// each an observation of its own: what the pixels of a patch have in common, be it noise or errors of the model,
    /// counts as found.
    Eigen::Matrix<double, kStates, kStates> covariance() const;
  };
  Equations linearize(const AlignmentState& state) const;
  bool refresh(const AlignmentState& state);
  static AlignmentState plus(const AlignmentState& state, const Step& step);
  /// About how far the step moves the image [px on this level].
  double stepSize(const Step& step) const;

  /// From now on the Huber threshold is one that suits the residuals at `state`, but no larger than that of the
  /// options.
  void followResiduals(const AlignmentState& state);
  void setHuberThreshold(double threshold) { loss_ = HuberLoss(threshold); }
  double huberThreshold() const { return loss_.threshold(); }

  int patches() const { return static_cast<int>(patches_.size()); }
  double medianInverseDepth() const { return median_inverse_depth_; }

 private:
  struct Patch {
    Eigen::Vector2d centre;  // integer pixel of the frame on this level
    double reference_row;    // of the point, on this level
    double inverse_depth;
    double inverse_depth_variance;
    double gain;                                   // by the vignettes that the two images lack
    std::array<float, kMaxPatchPixels> intensity;  // of the frame, NaN where invalid
    int pixels;                                    // that are valid in the frame
  };
  class Sums;

  void selectPatches(const AlignmentState& state);
  std::optional<Eigen::Vector2d> projectPoint(const ReferencePoint& point, const SE3& T_frame_reference,
                                              const BodyMotion& motion) const;
  double imageMotion(const Vector6& motion) const;  // about [px on this level]
  ExposureTrajectory trajectoryOf(const AlignmentState& state) const;
  PatchPathMaker pathMaker(const AlignmentState& state) const;
  /// False if the path leaves the reference.
  bool predict(const Patch& patch, const PatchPathMaker& maker, PatchPath& path, ReblurredPatch& predicted) const;
  void addPatch(const Patch& patch, const PatchPathMaker& maker, const AlignmentState& state, QuadraticModel& model,
                Sums& sums) const;
  void addPriors(const AlignmentState& state, Equations& equations) const;

  const Reference& reference_;
  const std::vector<int>& points_;
  const ImageLevel& reference_level_;
  const ImageLevel& frame_level_;
  const PatchPattern& pattern_;
  bool rolling_;
  VignetteRatio vignette_;
  AlignmentOptions options_;
  std::optional<AlignmentPrior> prior_;
  HuberLoss loss_;
  std::vector<Patch> patches_;
  double blur_px_ = 0.0;  // when they were chosen, about
  SE3 T_selected_;        // mid pose at which the patches were chosen
  double median_inverse_depth_ = 1.0;
};

}  // namespace mba_vo
