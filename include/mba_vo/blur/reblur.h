#pragma once

#include <array>

#include "mba_vo/blur/patch_path.h"
#include "mba_vo/blur/patch_pattern.h"
#include "mba_vo/image/image_pyramid.h"

namespace mba_vo {

/// Most samples along a path.
inline constexpr int kMaxSamples = 256;

/// Moments of the gradient along the path that are wanted, each with those before it: by depth and pose alone no second
/// ones, and none to compare intensities.
enum class GradientMoments { kOmitted, kFirst, kSecond };

/// Re-blurred patch (Eq. 6 with mid-point samples) and the moments of the image gradient along the path. With them the
/// derivative of pixel k is: d B / d delta = [gx gy] J_pose[0] + [ugx ugy] J_pose[1], and likewise for xi and depth.
/// Entries whose path leaves the reference or touches an invalid pixel are NaN in `value`.
struct ReblurredPatch {
  alignas(64) std::array<float, kMaxPatchPixels> value;
  alignas(64) std::array<float, kMaxPatchPixels> gx, gy;      // mean of the gradient [grey levels / px]
  alignas(64) std::array<float, kMaxPatchPixels> ugx, ugy;    // mean of u times the gradient
  alignas(64) std::array<float, kMaxPatchPixels> uugx, uugy;  // mean of u^2 times the gradient
};

/// The re-blurring kernel. `samples` in 1..kMaxSamples mid-points u_i = (i + 1/2) / n - 1/2. Fills the first
/// pattern.size entries of the values and of the moments that are wanted. Gradients are the exact derivative of the
/// bilinear interpolation.
void reblurPatch(const ImageLevel& reference, const PatchPath& path, const PatchPattern& pattern, int samples,
                 ReblurredPatch& out, GradientMoments wanted = GradientMoments::kSecond);

/// The values alone of a path that all pixels of the patch follow alike (A0 the identity, A1 zero).
void reblurParallel(const ImageLevel& level, const PatchPath& path, const PatchPattern& pattern, int samples,
                    std::array<float, kMaxPatchPixels>& value);

}  // namespace mba_vo
