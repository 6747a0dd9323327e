#pragma once

#include <array>

#include <Eigen/Core>

#include "mba_vo/blur/reblur.h"

namespace mba_vo {

/// Per pixel: gradient moments gx gy ugx ugy uugx uugy, predicted intensity, one.
inline constexpr int kMoments = 8;

/// How residuals are weighted.
struct PatchWeighting {
  float gain = 1.0F;              // of the frame relative to the reference
  float offset = 0.0F;            // [grey levels]
  float huber_threshold = 9.0F;   // [grey levels]
  float inlier_threshold = 9.0F;  // [grey levels] of `inliers` and `weighted_squares`, which judge the fit
  float noise = 3.0F;             // [grey levels] pixel noise that the effect of depth uncertainty is compared with
  float depth_x = 0.0F;           // shift of the looked-up pixel by one standard deviation of inverse depth [px]
  float depth_y = 0.0F;
};

/// Weighted sums over the valid pixels of a patch.
struct PatchSums {
  Eigen::Matrix<double, kMoments, kMoments> moments;  // sum of w m m^T
  Eigen::Matrix<double, kMoments, 1> residuals;       // sum of w m r
  double cost = 0.0;                                  // an invalid pixel costs as much as one at the threshold
  double weighted_squares = 0.0;                      // sum of w r^2, w that of the inlier threshold
  double inlier_squares = 0.0;                        // sum of r^2 of the inliers
  int inliers = 0;                                    // |r| <= inlier threshold
  int pixels = 0;                                     // valid
};

/// Residuals r = intensity - (gain * predicted + offset) of the first `size` pixels. `moving` false: the moments in u
/// are zero and left out.
PatchSums sumPatch(const ReblurredPatch& predicted, const std::array<float, kMaxPatchPixels>& intensity, int size,
                   bool moving, const PatchWeighting& weighting);

}  // namespace mba_vo
