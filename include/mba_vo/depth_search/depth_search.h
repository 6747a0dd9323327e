#pragma once

#include <optional>

#include "mba_vo/depth_search/epipolar_line.h"
#include "mba_vo/depth_search/immature_point.h"
#include "mba_vo/depth_search/search_host.h"
#include "mba_vo/depth_search/search_patch.h"
#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

struct DepthSearchConfig {
  double max_search_px = 40.0;
  double huber_threshold = 9.0;
  double min_search_px = 1.5;
  double min_blur_px = 1.0;
  double line_error_px = 0.2;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("max_search_px", c.max_search_px, 1.0, 500.0,
      "longest search along an epipolar line, or as far as things four times nearer than the others would be [px]");
    v("huber_threshold", c.huber_threshold, 0.1, 255.0, "Huber threshold of the search residual [grey levels]");
    v("min_search_px", c.min_search_px, 0.1, 10.0, "shorter intervals are not searched, they would not improve [px]");
    v("min_blur_px", c.min_blur_px, 0.1, 100.0, "from this motion within the exposure on, patches are re-blurred [px]");
    v("line_error_px", c.line_error_px, 0.01, 5.0,
      "expected error of the epipolar line, for the depth's interval [px]");
  }
};

/// A point of unknown depth at `pixel` of `host`.
ImmaturePoint makeImmaturePoint(const ImagePyramid& host, const Eigen::Vector2i& pixel,
                                const DepthSearchConfig& config);

/// Searches the depths of points of one host keyframe in one frame, along the epipolar lines at mid-exposure, and
/// narrows the points' intervals of inverse depth. Where the frame is more blurred than the host, the host's pattern is
/// re-blurred along the frame's exposure trajectory before it is compared.
class DepthSearcher {
 public:
  /// `T_host`: the frame's exposure trajectory relative to the host. `gain`, `offset`: expected frame intensity = gain
  /// * host intensity + offset. The pyramids must outlive the searcher.
  /// `vignette`: of the two images.
  DepthSearcher(const ImagePyramid& host, const ImagePyramid& frame, const ExposureTrajectory& T_host, double gain,
                double offset, const DepthSearchConfig& config, const SearchHost& known_of_host = {},
                const VignetteRatio& vignette = {});

  /// Safe to call from several threads for different points.
  void search(ImmaturePoint& point) const;

 private:
  struct Range {
    double begin, end;  // distances on the line [px]
    bool bounded;       // the end stems from a known upper bound of the inverse depth
  };
  struct Match {
    double s = 0.0;       // distance on the line [px]
    double energy = 0.0;  // infinite: nothing was found
    double error = 0.0;   // standard error of s [px]
  };
  struct Scan {
    Match best;
    Match second;  // next best place, beyond the flanks of the best one
  };
  struct Line {
    const EpipolarLine& epipolar;
    const SearchPatchMaker& patches;  // to be expected along it
  };

  DepthSearcher(const ImageLevel& host, const ImageLevel& frame, const ExposureTrajectory& T_host, double gain,
                double offset, const DepthSearchConfig& config, const SearchHost& known_of_host,
                const VignetteRatio& vignette);
  /// With a rolling shutter, each point and each row of the frame has a relative pose of its own.
  void searchRolling(ImmaturePoint& point) const;
  void searchInRow(double frame_row, ImmaturePoint& point) const;
  std::optional<double> expectedRow(const ImmaturePoint& point) const;
  void searchRange(const Line& line, const Range& range, ImmaturePoint& point) const;

  bool isInside(const Eigen::Vector2d& pixel) const;
  bool chooseRange(const EpipolarLine& line, ImmaturePoint& point, Range& range) const;
  double longestSearch(const EpipolarLine& line, double begin) const;
  int segmentCount(const Line& line, const Range& range) const;
  Scan scan(const ImmaturePoint& point, const Line& line, const Range& range) const;
  bool refine(const ImmaturePoint& point, const Line& line, const Range& range, Match& match) const;
  double qualityOf(const ImmaturePoint& point, const Line& line, const Range& range, const Match& match,
                   const Scan& scan) const;
  bool narrow(const EpipolarLine& line, const Range& range, const Match& match, ImmaturePoint& point) const;

  const ImageLevel* host_;
  const ImageLevel* frame_;
  DepthSearchConfig config_;
  double nearest_;  // inverse depth that a search is to reach [1/m]
  ExposureTrajectory T_host_;
  RigidMotion T_frame_host_;
  MovingPose T_frame_host_row_;  // for points of other than the host's middle row
  double gain_;
  double offset_;
  VignetteRatio vignette_;
  HostToFrame transform_;
  SearchPatchMaker patch_maker_;
};

}  // namespace mba_vo
