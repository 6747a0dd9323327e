#include "mba_vo/ros/camera_info.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace mba_vo {
namespace {

struct Region {
  double x_offset, y_offset, width, height;  // [px] at full resolution
};

Region regionOf(const sensor_msgs::CameraInfo& info) {
  const auto& roi = info.roi;
  if (roi.width == 0 && roi.height == 0) {  // by convention: the full image
    return {0.0, 0.0, static_cast<double>(info.width), static_cast<double>(info.height)};
  }
  if (roi.x_offset + roi.width > info.width || roi.y_offset + roi.height > info.height || roi.width == 0 ||
      roi.height == 0) {
    throw std::invalid_argument("camera_info: roi " + std::to_string(roi.width) + "x" + std::to_string(roi.height) +
                                " at (" + std::to_string(roi.x_offset) + ", " + std::to_string(roi.y_offset) +
                                ") is not inside the image of " + std::to_string(info.width) + "x" +
                                std::to_string(info.height));
  }
  return {static_cast<double>(roi.x_offset), static_cast<double>(roi.y_offset), static_cast<double>(roi.width),
          static_cast<double>(roi.height)};
}

void checkFocalLength(const char* name, double value) {
  if (!std::isfinite(value) || value <= 0.0) {
    throw std::invalid_argument(std::string("camera_info: ") + name + " is " + std::to_string(value) +
                                "; must be positive [px]: the camera has not been calibrated");
  }
}

/// Crops to the region, then bins. Pixel centres are at integers: binned pixel k covers k b .. k b + b - 1.
double cropAndBin(double centre, double offset, double binning) { return (centre - offset + 0.5) / binning - 0.5; }

}  // namespace

CameraCalibration calibrationFromCameraInfo(const sensor_msgs::CameraInfo& info, bool rectified) {
  const double fx = rectified ? info.P[0] : info.K[0];
  const double fy = rectified ? info.P[5] : info.K[4];
  checkFocalLength(rectified ? "P[0]" : "K[0]", fx);
  checkFocalLength(rectified ? "P[5]" : "K[4]", fy);
  if (info.width == 0 || info.height == 0) {
    throw std::invalid_argument("camera_info: image size is " + std::to_string(info.width) + "x" +
                                std::to_string(info.height) + "; must be positive [px]");
  }
  const Region region = regionOf(info);
  const double binning_x = info.binning_x == 0 ? 1.0 : info.binning_x;  // 0 and 1 both mean none
  const double binning_y = info.binning_y == 0 ? 1.0 : info.binning_y;

  CameraCalibration calibration;
  calibration.width = static_cast<int>(region.width / binning_x);
  calibration.height = static_cast<int>(region.height / binning_y);
  calibration.fx = fx / binning_x;
  calibration.fy = fy / binning_y;
  calibration.cx = cropAndBin(rectified ? info.P[2] : info.K[2], region.x_offset, binning_x);
  calibration.cy = cropAndBin(rectified ? info.P[6] : info.K[5], region.y_offset, binning_y);
  calibration.distortion_model = rectified ? "" : info.distortion_model;
  if (!rectified) {
    calibration.distortion = info.D;
  }
  return calibration;
}

sensor_msgs::CameraInfo cameraInfoFromCalibration(const CameraCalibration& calibration) {
  sensor_msgs::CameraInfo info;
  info.width = static_cast<std::uint32_t>(calibration.width);
  info.height = static_cast<std::uint32_t>(calibration.height);
  info.distortion_model = calibration.distortion_model;
  info.D = calibration.distortion;
  info.K = {calibration.fx, 0.0, calibration.cx, 0.0, calibration.fy, calibration.cy, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {calibration.fx, 0.0, calibration.cx, 0.0, 0.0, calibration.fy, calibration.cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

bool operator==(const CameraCalibration& a, const CameraCalibration& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy &&
         a.distortion_model == b.distortion_model && a.distortion == b.distortion;
}

}  // namespace mba_vo
