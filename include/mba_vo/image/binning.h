#pragma once

#include <opencv2/core.hpp>

#include "mba_vo/image/camera_calibration.h"

namespace mba_vo {

/// Pixels a side that are averaged to one that is worked with. `configured`: 0 = 2 where there are more than 600,000,
/// so that cameras of a megapixel run in real time. Row times of such images are as many times the camera's.
int binningOf(int configured, const CameraCalibration& calibration);

/// The camera of images so averaged. Rows and columns that are left over at the end are not seen.
CameraCalibration binned(const CameraCalibration& calibration, int binning);

/// Means; NaN where a pixel is NaN.
cv::Mat1f binned(const cv::Mat1f& image, int binning);

/// One depth of each, none in between.
cv::Mat1f binnedDepth(const cv::Mat1f& depth, int binning);

}  // namespace mba_vo
