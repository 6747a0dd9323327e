#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mba_vo/geometry/exposure_trajectory.h"
#include "mba_vo/image/image_pyramid.h"

namespace mba_vo {

struct DeblurConfig {
  std::string method = "none";

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("method", c.method, "how keyframes are deblurred: none");
  }
};

/// A pixel of the keyframe with known depth.
struct DepthSample {
  Eigen::Vector2f pixel;  // [px]
  float inverse_depth;    // [1/m]
};

/// What a deblurrer is given: the blurred keyframe, how the camera moved within its exposure, and the sparse depths.
struct DeblurInput {
  std::shared_ptr<const ImagePyramid> image;
  Vector6 xi = Vector6::Zero();     // motion within the exposure [m, rad]
  std::vector<DepthSample> depths;  // in the keyframe at mid-exposure
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

/// The implementation that the configuration names. Throws std::invalid_argument for an unknown method.
std::unique_ptr<Deblurrer> makeDeblurrer(const DeblurConfig& config);

}  // namespace mba_vo
