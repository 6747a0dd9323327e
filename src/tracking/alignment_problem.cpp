#include "mba_vo/tracking/alignment_problem.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mba_vo/blur/commuted_blur.h"
#include "mba_vo/geometry/median.h"
#include "mba_vo/solver/residual_spread.h"
#include "mba_vo/tracking/patch_sums.h"

namespace mba_vo {
namespace {

constexpr std::size_t kSpreadStride = 4;  // of the patches that tell the spread of the residuals: they are many
constexpr double kReselectShift = 1.0;    // [px] mean motion of the points after which the patches are chosen anew
constexpr double kPriorSigma = 2.2;  // of the pose, in Huber thresholds: correlation included, as residual_sigma is
constexpr double kBrightnessGainSigma = 1.0;
constexpr double kBrightnessOffsetSigma = 50.0;  // [grey levels]

}  // namespace

class AlignmentProblem::Sums {
 public:
  void add(const PatchSums& sums) {
    patches_ += sums.pixels > 0 ? 1 : 0;
    pixels_ += sums.pixels;
    inliers_ += sums.inliers;
    weighted_squares_ += sums.weighted_squares;
    inlier_squares_ += sums.inlier_squares;
  }
  void expect(int pixels) { expected_ += pixels; }

  AlignmentStatistics statistics() const {
    AlignmentStatistics s;
    s.patches = patches_;
    s.pixels = pixels_;
    s.inlier_fraction = expected_ > 0 ? static_cast<double>(inliers_) / expected_ : 0.0;
    s.rms = inliers_ > 0 ? std::sqrt(inlier_squares_ / inliers_) : 0.0;
    s.weighted_rms = pixels_ > 0 ? std::sqrt(weighted_squares_ / pixels_) : 0.0;
    return s;
  }

 private:
  int patches_ = 0;
  int pixels_ = 0;
  int inliers_ = 0;
  int expected_ = 0;
  double inlier_squares_ = 0.0;
  double weighted_squares_ = 0.0;
};

AlignmentProblem::AlignmentProblem(const Reference& reference, const std::vector<int>& points, const Frame& frame,
                                   int level, const PatchPattern& pattern, const AlignmentOptions& options,
                                   const std::optional<AlignmentPrior>& prior, const AlignmentState& initial)
    : reference_(reference),
      points_(points),
      reference_level_(reference.pyramid->level(level)),
      frame_level_(frame.pyramid.level(level)),
      pattern_(pattern),
      rolling_(frame_level_.camera.row_time != 0.0 || reference_level_.camera.row_time != 0.0),
      vignette_(reference.pyramid->level(0).camera, reference.image_correction.lacks(reference.correction),
                frame_level_.camera, frame.correction.lacks(reference.correction)),
      options_(options),
      prior_(prior),
      loss_(options.huber_threshold) {
  selectPatches(initial);
}

std::optional<Eigen::Vector2d> AlignmentProblem::projectPoint(const ReferencePoint& point, const SE3& T_frame_reference,
                                                              const BodyMotion& motion) const {
  const PinholeCamera& camera = reference_.pyramid->level(0).camera;
  const Eigen::Vector3d in_reference =
      camera.unproject(point.pixel.cast<double>()) / static_cast<double>(point.inverse_depth);
  if (!rolling_) {
    const Eigen::Vector3d p = T_frame_reference * in_reference;
    if (p.z() <= 0.0) return std::nullopt;
    return frame_level_.camera.project(p);
  }
  const double delay = camera.rowDelay(static_cast<double>(point.pixel.y()));
  const Eigen::Vector3d p = T_frame_reference * (SE3::exp(reference_.motion.until(delay)) * in_reference);
  const auto seen = projectRolling(frame_level_.camera, motion, p);
  return seen ? std::optional<Eigen::Vector2d>(seen->pixel) : std::nullopt;
}

void AlignmentProblem::selectPatches(const AlignmentState& state) {
  T_selected_ = state.T_reference_mid;
  const SE3 T_frame_reference = T_selected_.inverse();
  const BodyMotion motion = rolling_ ? trajectoryOf(state).motion() : BodyMotion();
  const CommutedBlur commuted(reference_level_.camera, frame_level_.camera, T_selected_, reference_.image_xi);
  const double row_scale = reference_.pyramid->level(0).camera.fy / reference_level_.camera.fy;
  patches_.clear();
  patches_.reserve(points_.size());
  for (const int index : points_) {
    const ReferencePoint& point = reference_.points[static_cast<std::size_t>(index)];
    const auto projection = projectPoint(point, T_frame_reference, motion);
    if (!projection) continue;
    const Eigen::Vector2d centre(std::round(projection->x()), std::round(projection->y()));
    if (!frame_level_.camera.contains(centre, pattern_.radius)) continue;
    const double reference_row = static_cast<double>(point.pixel.y() + 0.5F) / row_scale - 0.5;
    Patch patch{centre,
                reference_row,
                static_cast<double>(point.inverse_depth),
                static_cast<double>(point.variance),
                vignette_.at(point.pixel.cast<double>(), centre),
                {},
                0};
    commuted.read(frame_level_, centre, patch.inverse_depth, pattern_, static_cast<float>(options_.sample_spacing_px),
                  options_.max_samples, patch.intensity);
    patch.pixels = static_cast<int>(std::count_if(patch.intensity.begin(), patch.intensity.begin() + pattern_.size,
                                                  [](float value) { return !std::isnan(value); }));
    patches_.push_back(patch);
  }
  if (patches_.empty()) return;
  std::vector<double> inverse_depths;
  inverse_depths.reserve(patches_.size());
  for (const Patch& patch : patches_) inverse_depths.push_back(patch.inverse_depth);
  median_inverse_depth_ = median(std::move(inverse_depths));
  blur_px_ = imageMotion(state.xi);
}

bool AlignmentProblem::refresh(const AlignmentState& state) {
  const Vector6 moved = (T_selected_.inverse() * state.T_reference_mid).log();
  Step step = Step::Zero();
  step.head<6>() = moved;
  if (stepSize(step) < kReselectShift) return false;
  selectPatches(state);
  return true;
}

AlignmentState AlignmentProblem::plus(const AlignmentState& state, const Step& step) {
  AlignmentState next{state.T_reference_mid * SE3::exp(step.head<6>()),
                      state.xi + step.segment<6>(6),
                      state.a + step(12),
                      state.b + step(13),
                      state.bend,
                      state.log_exposure + step(kLogExposure)};
  next.bend.tail<3>() += step.segment<3>(14);
  const double longer = std::exp(step(kLogExposure));  // at the same velocity and acceleration
  next.xi *= longer;
  next.bend *= longer * longer;
  return next;
}

double AlignmentProblem::imageMotion(const Vector6& motion) const {
  return frame_level_.camera.fx * (median_inverse_depth_ * motion.head<3>().norm() + motion.tail<3>().norm());
}

double AlignmentProblem::stepSize(const Step& step) const {
  // Half of xi is where the exposure ends, or, with a rolling shutter, more where the last row is.
  const double last_row = rolling_ ? std::abs(frame_level_.camera.rowDelay(0.0)) / options_.exposure : 0.0;
  const double end = 0.5 + last_row;
  const double bend = frame_level_.camera.fx * step.segment<3>(14).norm();
  return std::max({imageMotion(step.head<6>()), end * imageMotion(step.segment<6>(6)), 0.5 * end * end * bend,
                   0.5 * blur_px_ * std::abs(step(kLogExposure))});
}

/// With a global shutter no times matter: the exposure is the unit.
ExposureTrajectory AlignmentProblem::trajectoryOf(const AlignmentState& state) const {
  const double exposure = rolling_ ? options_.exposure * std::exp(state.log_exposure) : 1.0;
  return {state.T_reference_mid, state.xi / exposure, exposure, state.bend / (exposure * exposure)};
}

PatchPathMaker AlignmentProblem::pathMaker(const AlignmentState& state) const {
  return {reference_level_.camera, frame_level_.camera, trajectoryOf(state), reference_.motion};
}

bool AlignmentProblem::predict(const Patch& patch, const PatchPathMaker& maker, PatchPath& path,
                               ReblurredPatch& predicted) const {
  if (!maker.make(patch.centre, patch.inverse_depth, path, patch.reference_row)) return false;
  reblurPatch(reference_level_, path, pattern_,
              sampleCount(path.length(), static_cast<float>(options_.sample_spacing_px), options_.max_samples),
              predicted);
  return true;
}

void AlignmentProblem::followResiduals(const AlignmentState& state) {
  const PatchPathMaker maker = pathMaker(state);
  const double gain = std::exp(state.a);
  const auto offset = static_cast<float>(state.b);
  std::vector<float> sizes;
  PatchPath path;
  ReblurredPatch predicted;
  for (std::size_t i = 0; i < patches_.size(); i += kSpreadStride) {
    if (!predict(patches_[i], maker, path, predicted)) continue;
    const auto patch_gain = static_cast<float>(gain * patches_[i].gain);
    for (std::size_t k = 0; k < static_cast<std::size_t>(pattern_.size); ++k) {
      const float size = std::abs(patches_[i].intensity[k] - (patch_gain * predicted.value[k] + offset));
      if (!std::isnan(size)) sizes.push_back(size);
    }
  }
  if (!sizes.empty()) setHuberThreshold(mba_vo::huberThreshold(residualSpread(sizes), options_.huber_threshold));
}

void AlignmentProblem::addPatch(const Patch& patch, const PatchPathMaker& maker, const AlignmentState& state,
                                QuadraticModel& model, Sums& sums) const {
  const int size = pattern_.size;
  const bool moving = options_.estimate_xi;
  sums.expect(patch.pixels);
  // A pixel that leaves the reference costs as much as one at the edge of being an outlier: leaving never pays.
  const double cost_of_leaving = loss_.cost(loss_.threshold());
  PatchPath path;
  ReblurredPatch predicted;
  if (!predict(patch, maker, path, predicted)) {
    model.cost += size * cost_of_leaving;
    return;
  }
  const auto sigma = static_cast<float>(std::sqrt(patch.inverse_depth_variance));
  PatchWeighting weighting;
  weighting.gain = static_cast<float>(patch.gain * std::exp(state.a));
  weighting.offset = static_cast<float>(state.b);
  weighting.huber_threshold = static_cast<float>(loss_.threshold());
  weighting.inlier_threshold = static_cast<float>(options_.huber_threshold);
  weighting.noise = static_cast<float>(options_.depth_noise);
  weighting.depth_x = sigma * static_cast<float>(path.J_inverse_depth[0].x());
  weighting.depth_y = sigma * static_cast<float>(path.J_inverse_depth[0].y());
  const PatchSums patch_sums = sumPatch(predicted, patch.intensity, size, moving, weighting);
  sums.add(patch_sums);
  if (patch_sums.pixels > 0) model.add(patch_sums, path, weighting.gain, moving, rolling_);
  model.cost += patch_sums.cost;
}

void AlignmentProblem::addPriors(const AlignmentState& state, Equations& equations) const {
  const double scale = options_.residual_sigma * options_.residual_sigma;
  const Eigen::Vector2d brightness_information(1.0 / (kBrightnessGainSigma * kBrightnessGainSigma),
                                               1.0 / (kBrightnessOffsetSigma * kBrightnessOffsetSigma));
  equations.addPrior<2>(12, Eigen::Vector2d(state.a, state.b), scale * brightness_information);
  equations.prior_scatter.segment<2>(12) = scale * scale * brightness_information;
  if (!prior_) return;
  // Small residuals, as blurred images leave them, speak louder against the predicted pose. Not against the expected
  // xi: what weak blur says about it is wrong by more than its noise.
  const double pose_sigma = std::min(options_.residual_sigma, kPriorSigma * loss_.threshold());
  const double pose_scale = pose_sigma * pose_sigma;
  // Log(T_prior^-1 T Exp(d)) ~ Log(T_prior^-1 T) + d for the small deviations where the prior matters.
  const Vector6 deviation = (prior_->T_reference_mid.inverse() * state.T_reference_mid).log();
  equations.addPrior<6>(0, deviation, pose_scale * prior_->pose_information);
  const double longer = std::exp(state.log_exposure);
  const double longer2 = longer * longer;
  const Vector6 xi_information = prior_->xi_information / longer2;
  const Eigen::Vector3d bend_information = prior_->turn_bend_information / (longer2 * longer2);
  equations.addPrior<6>(6, state.xi - longer * prior_->xi, scale * xi_information);
  equations.addPrior<3>(14, state.bend.tail<3>() - longer2 * prior_->turn_bend, scale * bend_information);
  // Nor is the exposure known as surely as coarse noise would have it: it, too, gives way to small residuals.
  equations.log_exposure_prior = pose_scale * prior_->log_exposure_information;
  equations.addPrior<1>(kLogExposure, Eigen::Matrix<double, 1, 1>(state.log_exposure),
                        Eigen::Matrix<double, 1, 1>(equations.log_exposure_prior));
  // The gradient of a prior scatters by its weight times the deviation that it expects.
  equations.prior_scatter.head<6>() = pose_scale * pose_scale * prior_->pose_information;
  equations.prior_scatter.segment<6>(6) = scale * scale * xi_information;
  equations.prior_scatter.segment<3>(14) = scale * scale * bend_information;
  equations.prior_scatter(kLogExposure) = pose_scale * equations.log_exposure_prior;
}

Eigen::Matrix<double, AlignmentProblem::kStates, AlignmentProblem::kStates> AlignmentProblem::Equations::covariance()
    const {
  const Eigen::Matrix<double, kStates, kStates> inverse = hessian.inverse();
  Eigen::Matrix<double, kStates, kStates> scatter = prior_scatter.asDiagonal();
  for (const QuadraticModel::PatchGradient& g : patch_gradients) {
    const Eigen::Map<const Step> of_patch(g.data());
    scatter += of_patch * of_patch.transpose();
  }
  return inverse * scatter * inverse;
}

AlignmentProblem::Equations AlignmentProblem::linearize(const AlignmentState& state) const {
  QuadraticModel model(options_.with_covariance ? patches_.size() : 0);
  Sums sums;
  const PatchPathMaker maker = pathMaker(state);
  for (const Patch& patch : patches_) addPatch(patch, maker, state, model, sums);
  Equations equations;
  model.copyTo(equations);
  equations.patch_gradients = model.takePatchGradients();
  addPriors(state, equations);
  if (!options_.estimate_xi) equations.fix(6, 6);
  if (!options_.estimate_turn_bend) equations.fix(14, 3);
  if (!options_.estimate_exposure) equations.fix(kLogExposure, 1);
  if (options_.rotation_only) {
    equations.fix(0, 3);
    equations.fix(6, 3);
  }
  equations.statistics = sums.statistics();
  return equations;
}

}  // namespace mba_vo
