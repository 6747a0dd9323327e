#pragma once

#include <memory>

#include "mba_vo/geometry/exposure_trajectory.h"
#include "mba_vo/image/image_pyramid.h"
#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// What a deblurrer is given: the blurred keyframe, how the camera moved within its exposure, and the sparse depths.
struct DeblurInput {
  std::shared_ptr<const ImagePyramid> image;
  ExposureTrajectory trajectory;       // relative to the keyframe itself at mid-exposure: T_reference_mid = identity
  std::vector<ReferencePoint> points;  // known depths in the keyframe
};

/// Turns a blurred keyframe into a sharp one. Implementations are stateless and may be called from any thread.
class Deblurrer {
 public:
  virtual ~Deblurrer() = default;
  virtual std::shared_ptr<const ImagePyramid> deblur(const DeblurInput& input) const = 0;
};

/// Hands the image through unchanged.
class PassThroughDeblurrer final : public Deblurrer {
 public:
  std::shared_ptr<const ImagePyramid> deblur(const DeblurInput& input) const override { return input.image; }
};

}  // namespace mba_vo
