#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mba_vo/initialization/initializer_bundle.h"

namespace mba_vo {

/// One image's tracks of the reference's points.
struct StructureView {
  std::vector<Eigen::Vector2d> pixel;  // by point [px]
  std::vector<char> tracked;           // by point
  double log_sharpness = 0.0;          // relative to the other views
  double time = 0.0;                   // mid-exposure, since that of the reference [s]
};

/// Tracks from which structure and motion are estimated.
struct StructureProblem {
  PinholeCamera camera;
  std::vector<Eigen::Vector2d> reference_pixels;  // by point [px]
  std::vector<StructureView> views;               // by time
};

struct StructureConfig {
  double min_parallax = 0.02;  // translation over median depth
  int min_points = 60;         // tracked in a view that takes part, and in the result
  double min_visible = 0.3;    // share of the points tracked in a view that takes part
  std::size_t max_bundle_views = 12;
  double max_relative_depth_sigma = 0.1;  // median over the points
  bool find_row_time = false;             // if the camera has none
};

/// Structure and motion, or why there are none. Scale: median inverse depth = 1.
struct StructureEstimate {
  bool accepted = false;
  std::string reason;                                // why not; empty if accepted
  std::vector<std::optional<SE3>> T_view_reference;  // by view, where known
  std::vector<double> inverse_depth;                 // by point
  std::vector<double> variance;       // of the inverse depth, by point; infinite where the point is no good
  double parallax = 0.0;              // largest translation of a trusted view
  double rotation_residual = 0.0;     // largest flow that rotation does not explain (median over points) [px]
  double reprojection_error = 0.0;    // median in the views that took part [px]
  double validation_error = 0.0;      // median in the views that did not [px]
  double relative_depth_sigma = 0.0;  // median of sigma(w)/w
  int points = 0;                     // with finite variance
  int residuals = 0;                  // of the bundles that were adjusted
  double row_time = 0.0;              // that was found, on top of the camera's [s]
};

/// Bundle adjustment over the best views from several starts (essential matrix, homography, depth reversed), which must
/// have one clear winner that explains the views left out. An initial guess of nothing is needed.
StructureEstimate estimateStructure(const StructureProblem& problem, const StructureConfig& config);

}  // namespace mba_vo
