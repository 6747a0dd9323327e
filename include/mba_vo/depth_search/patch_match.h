#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "mba_vo/depth_search/search_patch.h"

namespace mba_vo {

/// Noise of an interpolated intensity, the interpolation's own error included [grey levels].
inline constexpr double kMatchNoise = 2.0;

/// Sum of the Huber energies of the patch with its centre at `centre` of the image; all its pixels must be inside. NaN
/// if an invalid pixel is touched.
float patchEnergy(const cv::Mat1f& image, const SearchPatch& patch, const Eigen::Vector2d& centre, float threshold);

/// Normal equation of one Gauss-Newton step along an epipolar line, and the structure of the image gradient there.
struct LineStep {
  double hessian = 0.0;   // sum of w g_along^2
  double gradient = 0.0;  // sum of w g_along r
  double along = 0.0;     // sum of g_along^2
  double mixed = 0.0;     // sum of g_along g_across
};

LineStep linearise(const cv::Mat1f& image, const SearchPatch& patch, const Eigen::Vector2d& centre,
                   const Eigen::Vector2d& direction, double threshold);

/// Standard error of a match [px]: an error of the line across its direction moves the match along it where edges are
/// oblique; noise moves it where gradients along the line are small.
double matchError(const LineStep& step, double line_error_px);

}  // namespace mba_vo
