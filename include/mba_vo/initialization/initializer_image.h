#pragma once

#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/image/frame.h"

namespace mba_vo {

/// A frame reduced to what feature tracking needs. It works on the coarsest level that is still at least 320 px wide,
/// so that its cost does not depend on the resolution of the camera; pixels below are those of that level.
struct InitializerImage {
  FrameConstPtr frame;
  int level = 0;                 // of the frame's pyramid
  PinholeCamera camera;          // of that level
  cv::Mat1b grey;                // invalid pixels are 0
  cv::Mat1b mask;                // 255 where a feature may lie: inside, and away from invalid pixels
  std::vector<cv::Mat> pyramid;  // of `grey`, for cv::calcOpticalFlowPyrLK
  cv::Mat1f block_energy;        // mean squared gradient of blocks of kBlockSize [(grey levels / px)^2]

  static constexpr int kBlockSize = 16;   // [px]
  static constexpr int kFlowWindow = 21;  // [px]
  static constexpr int kFlowLevels = 3;   // above level 0

  Eigen::Vector2d toLevel0(const Eigen::Vector2d& pixel) const;
};

using InitializerImageConstPtr = std::shared_ptr<const InitializerImage>;

/// Throws std::invalid_argument if the frame has no image.
InitializerImageConstPtr makeInitializerImage(const FrameConstPtr& frame);

/// Corners (large smaller eigenvalue of the gradient's second moments), the best of every cell of a grid, at most
/// `max_count`, strongest first.
std::vector<cv::Point2f> selectCorners(const InitializerImage& image, int max_count);

/// How the image moved between two frames that follow each other, in working pixels.
struct ImageMotion {
  bool measured = false;                                          // false: too little in common, the motion is a guess
  Eigen::Matrix3d H_next_previous = Eigen::Matrix3d::Identity();  // homography
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  // log(R_next_previous) that explains the flow best [rad]
  double sharpness_gain = 0.0;  // log of the ratio of gradient energies, next to previous, where both see the same
};

/// `guess`: expected log(R_next_previous) [rad]; it becomes the result if nothing can be measured.
ImageMotion measureMotion(const InitializerImage& previous, const InitializerImage& next, const Eigen::Vector3d& guess);

/// Homography of a pure rotation, K R K^-1, with R = Exp(rotation).
Eigen::Matrix3d rotationHomography(const PinholeCamera& camera, const Eigen::Vector3d& rotation);

Eigen::Vector2d applyHomography(const Eigen::Matrix3d& H, const Eigen::Vector2d& pixel);

}  // namespace mba_vo
