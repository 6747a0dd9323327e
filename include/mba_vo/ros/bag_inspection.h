#pragma once

#include <string>

#include "mba_vo/inspection/folder_inspection.h"

namespace mba_vo {

struct BagInspectionOptions {
  std::string image_topic;       // the one to look at; empty = each with images
  std::string calibration_file;  // in place of camera_info; empty = that
  std::string camera;            // of several in the calibration file; empty = cam0, or the only one
};

/// Looks at all of a rosbag, without a ROS master, and goes on after what is wrong. What cannot be read at all is told
/// in the report.
InspectionReport inspectBag(const std::string& file, const BagInspectionOptions& options,
                            const InspectionProgress& progress);

}  // namespace mba_vo
