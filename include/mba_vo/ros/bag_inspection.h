#pragma once

#include <string>

#include "mba_vo/inspection/folder_inspection.h"

namespace mba_vo {

/// Looks at all of a rosbag, without a ROS master, and goes on after what is wrong: at each topic with images, or at
/// `image_topic` alone unless it is empty. What cannot be read at all is told in the report.
InspectionReport inspectBag(const std::string& file, const std::string& image_topic,
                            const InspectionProgress& progress);

}  // namespace mba_vo
