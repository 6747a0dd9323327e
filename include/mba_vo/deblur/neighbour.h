#pragma once

#include <cstdint>
#include <memory>

#include <opencv2/core.hpp>

#include "mba_vo/deblur/dense_inverse_depth.h"
#include "mba_vo/deblur/latent_path.h"
#include "mba_vo/image/image_pyramid.h"

namespace mba_vo {

/// Another frame that saw what the keyframe saw, shortly before or after.
struct DeblurNeighbour {
  std::shared_ptr<const ImagePyramid> image;
  std::uint64_t sequence = 0;  // of the frame
  ExposureTrajectory motion;   // T_reference_mid: its camera to the keyframe's, both at mid-exposure
  // Its intensity is gain * that of the keyframe + offset [grey levels].
  double gain = 1.0;
  double offset = 0.0;
};

/// Inverse depth of every pixel of the neighbour [1/m], from the keyframe's samples; empty without a usable one.
cv::Mat1f denseInverseDepth(const DeblurNeighbour& neighbour, const PinholeCamera& keyframe_camera,
                            const std::vector<DepthSample>& samples);

/// One level of a neighbour and its geometry.
struct NeighbourLevel {
  const DeblurNeighbour* neighbour;
  int level;
  BlurGeometry geometry;
  // By how much the keyframe's pixels are found elsewhere than by geometry alone [px of the keyframe's level], spread
  // evenly over the image; empty = nowhere.
  cv::Mat2f correction;
};

/// The neighbour's image laid over the keyframe: at each pixel of the keyframe the intensity, in the keyframe's grey
/// levels, at the pixel of the neighbour that looks there at mid-exposure. What the motion smeared stays smeared: the
/// BlurOperator of the same geometry says along which path. NaN where the neighbour looks elsewhere, is saturated or
/// invalid, or where by the depths something else is in front (the two depths differ by more than 1 px of parallax).
/// Both inverse depths are of this level [1/m].
cv::Mat1f overlay(const NeighbourLevel& neighbour, const cv::Mat1f& keyframe_depth, const cv::Mat1f& neighbour_depth);

}  // namespace mba_vo
