#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace mba_vo {

/// What a depth image says about one point.
struct MeasuredDepth {
  double inverse_depth = 0.0;  // [1/m]
  double variance = 0.0;       // of the inverse depth [1/m^2]; 0 = nothing was measured

  bool known() const { return variance > 0.0; }
};

/// The errors of depth images.
struct DepthSensorConfig {
  double inverse_depth_sigma = 0.003;
  double relative_sigma = 0.01;
  double registration_sigma = 1.0;
  double max_depth = 10.0;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("inverse_depth_sigma", c.inverse_depth_sigma, 0.0, 1.0,
      "error of depth images as of triangulation: of the inverse depth, the same everywhere [1/m]");
    v("relative_sigma", c.relative_sigma, 1e-4, 0.5, "and that which grows with the depth, relative to it");
    v("registration_sigma", c.registration_sigma, 0.0, 20.0, "by which depth image and image are shifted [px]");
    v("max_depth", c.max_depth, 0.1, 1e4, "beyond it measured depths are not believed [m]");
  }
};

/// Reads a depth image z [m], NaN = unknown, at a pixel. Nothing near an edge of the depths or a hole: what belongs to
/// the pixel there is a matter of luck.
MeasuredDepth measureDepth(const cv::Mat1f& depth, const Eigen::Vector2i& pixel, const DepthSensorConfig& config);

}  // namespace mba_vo
