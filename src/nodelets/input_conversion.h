#pragma once

#include "mba_vo/odometry/camera_image.h"
#include "mba_vo/ros/conversions.h"
#include "mba_vo/ros/image_assembler.h"

namespace mba_vo {

/// What came as messages, as the tracker takes it; without pixels, and told why, if they are of no use.
CameraImage toCameraImage(const InputImage& input, StampReference stamp_reference);

}  // namespace mba_vo
