#pragma once

#include <string>

#include <visualization_msgs/MarkerArray.h>

#include "mba_vo/ros/motion_messages.h"

namespace mba_vo {

/// What a camera moved through while the shutter was open, and where the keyframes of the window are, in `map_frame`,
/// stamped at mid-exposure:
///   exposure/0  frustum at the start of the exposure         (LINE_LIST, green)
///   exposure/1  frustum at its end                           (LINE_LIST, orange)
///   exposure/2  what the edges of the image swept in between (TRIANGLE_LIST)
///   exposure/3  ways of the camera and of the corners        (LINE_LIST)
///   keyframes/0 frusta of the keyframes                      (LINE_LIST, blue)
/// The motion is not exaggerated; sizes follow the median depth of the points. `reference`: that the frame was tracked
/// with.
visualization_msgs::MarkerArray makeMarkers(const MeasuredMotion& motion, const Reference& reference,
                                            const std::string& map_frame);

/// Takes all of them away.
visualization_msgs::MarkerArray deleteMarkers();

}  // namespace mba_vo
