#pragma once

#include "mba_vo/blur/reblur.h"
#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

struct DepthSearchConfig {
  double max_search_px = 40.0;
  double huber_threshold = 9.0;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("max_search_px", c.max_search_px, 1.0, 500.0, "longest search along an epipolar line [px]");
    v("huber_threshold", c.huber_threshold, 0.1, 255.0, "Huber threshold of the search residual [grey levels]");
  }
};

/// A point whose depth is still being found (DSO calls it immature).
struct ImmaturePoint {
  Eigen::Vector2i pixel;       // in its host keyframe, level 0
  double inverse_depth_min = 0.0;   // [1/m]
  double inverse_depth_max = -1.0;  // [1/m]; negative: no upper bound known yet
  double energy_threshold = 0.0;    // of the pattern, from its gradients
  double quality = 0.0;             // second-best over best search energy; higher is more certain
  double last_search_length_px = 0.0;
  enum class State { kUninitialized, kGood, kOutlier, kOutOfBounds, kSkipped, kBadCondition } state =
      State::kUninitialized;
  bool hasDepth() const { return inverse_depth_max > 0.0; }
  double inverseDepth() const { return 0.5 * (inverse_depth_min + inverse_depth_max); }
};

/// Searches the depth of `point` (hosted in `host`, sharp) in `frame`, whose exposure trajectory relative to the host is
/// `T_host`, along the epipolar line at mid-exposure, and narrows the point's interval of inverse depths.
/// `gain`, `offset`: expected frame intensity = gain * host intensity + offset.
void searchDepth(const ImagePyramid& host, const ImagePyramid& frame, const ExposureTrajectory& T_host, double gain,
                 double offset, const DepthSearchConfig& config, ImmaturePoint& point);

}  // namespace mba_vo
