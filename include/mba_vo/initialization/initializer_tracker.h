#pragma once

#include <vector>

#include "mba_vo/initialization/initializer_image.h"

namespace mba_vo {

/// Where the corners of a reference image are seen in another image, in working pixels.
struct FrameTracks {
  std::vector<Eigen::Vector2d> pixel;                               // by corner; predicted where not tracked
  std::vector<char> tracked;                                        // by corner
  int count = 0;                                                    // of the tracked ones
  Eigen::Matrix3d H_frame_reference = Eigen::Matrix3d::Identity();  // homography that fits the tracks best
};

/// Finds the corners of one sharp image in others. Every image is aligned with the reference itself, so nothing drifts:
/// the reference is warped by the predicted homography, blurred like the image, and the corners' windows are matched.
class ReferenceTracker {
 public:
  ReferenceTracker(InitializerImageConstPtr reference, int max_corners);

  const std::vector<Eigen::Vector2d>& corners() const { return corners_; }

  /// Tracks of the reference in itself, to start from.
  FrameTracks identity() const;

  /// `neighbour`: tracks in an image next to `image` in time; `H_image_neighbour`: homography between these two;
  /// `exposure_rotation`: rotation of the camera during the exposure of `image` [rad], its blur.
  FrameTracks track(const InitializerImage& image, const FrameTracks& neighbour,
                    const Eigen::Matrix3d& H_image_neighbour, const Eigen::Vector3d& exposure_rotation) const;

 private:
  InitializerImageConstPtr reference_;
  std::vector<Eigen::Vector2d> corners_;
};

}  // namespace mba_vo
