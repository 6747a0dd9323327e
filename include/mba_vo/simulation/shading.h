#pragma once

#include <vector>

#include "mba_vo/simulation/view.h"

namespace mba_vo {

/// Adds weight * light of `projected` to the pixels of a block; the texture is filtered to the size of a pixel.
/// `weights`: RayBlock::kPixels values, null = 1 everywhere.
void shade(const RayBlock& block, const ProjectedSurface& projected, const float* weights, float* light);

/// What the pixels of a block see.
class VisibilityBuffer {
 public:
  /// Casts one ray per pixel, shifted by (dx, dy) [px] from its centre.
  void cast(const RayBlock& block, const Candidates& candidates, float dx, float dy);
  /// After cast(): 1/z of each pixel, 0 = nothing there.
  const float* inverseDepth() const { return inverse_depth_; }

  /// Adds the light of the block to `light`: coverage by `samples` rays per pixel in a pattern that `sub_frame`
  /// chooses, one texture look-up per pixel and surface.
  void integrate(const RayBlock& block, const Candidates& candidates, int sub_frame, int samples, float* light);

 private:
  float inverse_depth_[RayBlock::kPixels];
  int surface_[RayBlock::kPixels];  // index of the candidate, -1 = nothing
  std::vector<float> coverage_;     // candidate by pixel
};

}  // namespace mba_vo
