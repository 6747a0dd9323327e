#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "recorded_run.h"

namespace mba_vo::study {

/// Of the points of the map that the camera truly sees: distance between where the estimate and where the truth put
/// them in the image.
struct PointErrors {
  double mean = 0.0;   // [px]
  double right = 0.0;  // share of the points that are right
};

/// The true place of a point is what the true pose, in units of the map by `scale`, makes of the estimated point.
PointErrors errorsOfPose(const Reported& reported, const SE3& T_reference_frame, double scale);

/// The true place of a point is that of the surface seen at its pixel of the keyframe, whose true depths are given.
/// Nothing has to be known of the scale. Points at the edge of something belong to the surface that suits them best.
PointErrors errorsOfSurface(const Reported& reported, const SE3& T_reference_frame, const cv::Mat1f& depth);

/// True over estimated depth of the reference's points, median.
double scaleOfPoints(const Reference& reference, const cv::Mat1f& depth);

}  // namespace mba_vo::study
