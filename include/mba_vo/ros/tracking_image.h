#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// A point of the reference as a frame saw it.
struct DrawnPoint {
  std::vector<Eigen::Vector2d> path;  // its image from the start of the exposure to its end [px]; all within the image
  double depth = 0.0;                 // z in the camera at mid-exposure [m], up to scale
};

/// The way of a point of the reference [m] through the image while the shutter was open, from start to end [px], in
/// `steps` equal parts of the exposure. Under a rolling shutter: while the row was exposed in which it is at
/// mid-exposure. Empty where it is behind the camera or outside of the image.
std::vector<Eigen::Vector2d> blurPath(const Eigen::Vector3d& point_reference, const ExposureTrajectory& trajectory,
                                      const PinholeCamera& camera, int steps);

/// All points of the reference that are in the image throughout. None for a reference without depths.
std::vector<DrawnPoint> drawnPoints(const TrackedFrame& tracked, const Reference& reference);

/// The frame's image, rectified, in grey; over it each point with the path of its blur, the dot at the end of the
/// exposure, from red (near) to blue (far); below it what became of the frame. `reference`: that it was tracked with;
/// null, or another one, or a frame without a pose: no points.
cv::Mat3b drawTracking(const TrackedFrame& tracked, const ReferenceConstPtr& reference);

}  // namespace mba_vo
