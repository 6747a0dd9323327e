#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "mba_vo/deblur/blur_operator.h"
#include "mba_vo/deblur/half_quadratic_solver.h"
#include "mba_vo/image/image_pyramid.h"

namespace mba_vo {

/// A blurred image and the way it was blurred, as the solver takes it.
class Observation {
 public:
  /// `image`: laid over the sharp one. NaN, pixels with `limit` [grey levels] or more and those whose path leaves the
  /// grid have no weight.
  Observation(const BlurGeometry& geometry, const cv::Mat1f& inverse_depth, const LatentGrid& grid,
              const cv::Mat1f& image, float noise, float limit);
  Observation(const Observation&) = delete;  // data_ points to blur_
  Observation& operator=(const Observation&) = delete;

  const BlurOperator& blur() const { return blur_; }
  const BlurredObservation& data() const { return data_; }
  int pixels() const { return cv::countNonZero(data_.weight); }  // with a weight
  /// Adds a `variance` [grey levels^2] of each pixel to that of the noise; it may be of another resolution.
  void distrust(const cv::Mat1f& variance);

  /// Rms of `latent` blurred again minus the image [standard deviations of the noise].
  float residual(const cv::Mat1f& latent) const;

 private:
  BlurOperator blur_;
  BlurredObservation data_;
};

/// One level of the keyframe, and perhaps of a neighbour, and the sharp image that explains them.
class LevelProblem {
 public:
  LevelProblem(const ImageLevel& level, const ExposureTrajectory& motion, const cv::Mat1f& depth, float reach,
               float noise);

  const Observation& keyframe() const { return keyframe_; }
  const LatentGrid& grid() const { return keyframe_.blur().grid(); }

  /// The blurred image itself, its border continued.
  cv::Mat1f blurredStart() const;
  /// The solution of the level with half the resolution, on this level's grid.
  cv::Mat1f startFrom(const LevelProblem& coarse, const cv::Mat1f& solution) const;
  /// `neighbour`: on the same grid, or null.
  void solve(const HalfQuadraticConfig& config, const Observation* neighbour, cv::Mat1f& latent) const;
  /// The part of `latent` that is the keyframe.
  cv::Mat1f image(const cv::Mat1f& latent) const;

 private:
  cv::Size size_;
  Observation keyframe_;
};

}  // namespace mba_vo
