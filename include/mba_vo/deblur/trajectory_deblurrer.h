#pragma once

#include "mba_vo/deblur/deblurrer.h"

namespace mba_vo {

/// Non-blind deconvolution: the motion within the exposure and the depths say along which path each pixel was smeared
/// (BlurOperator); the sharp image is the one that, smeared so, gives the blurred one, and has the least total
/// variation otherwise (solveHalfQuadratic), on half the resolution first. What the camera could not measure (saturated
/// or invalid pixels) does not count. The result is only handed out if it explains the input when blurred again.
class TrajectoryDeblurrer final : public Deblurrer {
 public:
  explicit TrajectoryDeblurrer(const TrajectoryDeblurConfig& config) : config_(config) {}

  DeblurResult deblur(const DeblurInput& input) const override;

 private:
  TrajectoryDeblurConfig config_;
};

}  // namespace mba_vo
