#pragma once

#include <string>

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/Image.h>
#include <opencv2/core.hpp>

namespace mba_vo {

/// The pixels of a message in a form that FrameBuilder takes; grey and BGR images are shared, not copied, and live as
/// long as the result. Throws std::invalid_argument naming the encoding if that is not an image of light.
cv_bridge::CvImageConstPtr toCvImage(const sensor_msgs::ImageConstPtr& message);

/// ROS encoding of an image as FrameBuilder and OpenCV understand it: mono8, mono16, bgr8, ...
/// Throws std::invalid_argument for other types.
std::string encodingOf(const cv::Mat& image);

}  // namespace mba_vo
