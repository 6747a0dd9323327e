#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/geometry/calibration_correction.h"
#include "mba_vo/geometry/pinhole_camera.h"
#include "mba_vo/image/camera_calibration.h"

namespace mba_vo {

/// Warps linear images of a distorted camera to those of an ideal pinhole camera of the same size.
///
/// Choice of the rectified camera: principal point as in the calibration, both focal lengths scaled by one factor, the
/// smallest for which at least 95 % of the rectified pixels are seen by the camera (but not below a half). So almost
/// the whole field of view is kept, at the price of a few invalid pixels in the corners. An undistorted camera is
/// left as it is, and its images pass through without interpolation. A correction of the calibration changes the images
/// but not the camera, so that images with different corrections can be compared.
class Rectifier {
 public:
  /// Throws std::invalid_argument for an impossible calibration.
  explicit Rectifier(const CameraCalibration& calibration, const CalibrationCorrection& correction = {});

  const PinholeCamera& camera() const { return camera_; }
  bool isIdentity() const { return samples_.empty(); }

  /// Rectified image; NaN where the bilinear footprint touches the outside of the image or a NaN.
  cv::Mat1f rectify(const cv::Mat1f& image) const;
  /// Rectified depths, each that of the nearest pixel: between the two sides of an edge there is nothing. Depths along
  /// the optical axis, which stays where it is, stay as they are.
  cv::Mat1f rectifyDepth(const cv::Mat1f& depth) const;

 private:
  struct Sample {
    std::int32_t offset;  // of the upper left pixel of the footprint; negative = outside
    float wx, wy;         // weights of the right and the lower pixels
  };

  PinholeCamera camera_;
  std::vector<Sample> samples_;  // one per pixel, row by row; empty = identity
};

}  // namespace mba_vo
