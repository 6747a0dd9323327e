#pragma once

#include <vector>

#include <Eigen/Core>

#include "mba_vo/image/image_pyramid.h"

namespace mba_vo {

/// Root mean square of the derivative of the intensity along one direction, in squares of 9x9 pixels around `centres`
/// [grey levels / px]. Pixels without valid neighbours do not count; 0 if none is left.
double rmsGradient(const ImageLevel& level, const std::vector<Eigen::Vector2d>& centres);

/// False if the image shows nothing to go by: black, saturated, or the lens covered.
bool hasContent(const ImagePyramid& pyramid);

/// Mean intensity of a small version of the image, before its gain [grey levels]; 0 if nothing is valid.
double meanBrightness(const ImagePyramid& pyramid);

/// Standard deviation of the intensity of a small version of the image [grey levels]; 0 if nothing is valid.
double contrast(const ImagePyramid& pyramid);

}  // namespace mba_vo
