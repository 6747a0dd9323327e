#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mba_vo/deblur/deblur_config.h"
#include "mba_vo/deblur/dense_inverse_depth.h"
#include "mba_vo/deblur/neighbour.h"
#include "mba_vo/geometry/exposure_trajectory.h"
#include "mba_vo/image/image_pyramid.h"

namespace mba_vo {

/// What a deblurrer is given: the blurred keyframe, how the camera moved within its exposure, and the sparse depths.
struct DeblurInput {
  std::shared_ptr<const ImagePyramid> image;
  std::uint64_t sequence = 0;  // of the frame
  ExposureTrajectory motion;   // relative to the keyframe at mid-exposure: T_reference_mid is the identity
  // The velocity by another measurement, if there is one [m/s, rad/s]: where the two disagree, none is trusted.
  std::optional<Vector6> other_velocity;
  std::vector<DepthSample> depths;  // in the keyframe at mid-exposure
  // Frames shortly before and after with known poses, in any order; those whose motion is uncertain are better left
  // out. The deblurrer chooses the one that helps most, if any does.
  std::vector<DeblurNeighbour> neighbours;
};

/// What became of the neighbours.
struct NeighbourUse {
  std::optional<std::uint64_t> sequence;  // of the frame that was used
  std::string reason;                     // why none was; empty if one was
  float expected_gain_db = 0.0F;          // of the best one, by the directions and lengths of the blurs [dB]
  float shift_px = 0.0F;                  // between it and what is expected of it, if it came to that: median [px]
  float residual = 0.0F;                  // as DeblurResult::residual, of the neighbour, if it came to that
};

struct DeblurResult {
  std::shared_ptr<const ImagePyramid> image;  // the input itself if not sharpened
  bool sharpened = false;
  std::string reason;     // why not; empty if sharpened
  float blur_px = 0.0F;   // median path of the pixels within the exposure, if known [px]
  float residual = 0.0F;  // rms of result blurred again minus input, if sharpened by the motion [standard deviations]
  NeighbourUse neighbour;
};

/// Turns a blurred keyframe into a sharp one. Implementations are stateless and may be called from any thread.
class Deblurrer {
 public:
  virtual ~Deblurrer() = default;
  virtual DeblurResult deblur(const DeblurInput& input) const = 0;
};

/// Hands the image through unchanged.
class PassThroughDeblurrer final : public Deblurrer {
 public:
  DeblurResult deblur(const DeblurInput& input) const override;
};

/// The implementation that the configuration names. Throws std::invalid_argument for an unknown method, and whatever
/// the method's own constructor throws.
std::unique_ptr<Deblurrer> makeDeblurrer(const DeblurConfig& config);

}  // namespace mba_vo
