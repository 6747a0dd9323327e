#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "mba_vo/inspection/camera_facts.h"
#include "mba_vo/inspection/finding.h"

namespace mba_vo {

/// Where a camera is found in the recording, as options of the programs; empty = not needed, or there is none.
struct RecordedCamera {
  std::string name;              // for people
  std::string image;             // topic
  std::string camera_info;       // topic
  std::string exposure;          // topic
  std::string images_subfolder;  // of a folder
  std::string camera;            // of several, of a folder
  std::string calibration_file;  // in place of the recording's own
  bool compressed = false;       // image is a topic of sensor_msgs/CompressedImage
};

struct CameraReport {
  RecordedCamera source;
  CameraFacts facts;
  std::vector<Finding> findings;
};

/// All that is to be told of a recording.
struct InspectionReport {
  std::string path;
  bool is_bag = false;
  bool readable = true;
  std::vector<std::string> contents;  // one line per topic or file
  std::vector<Finding> findings;      // of the recording as a whole
  std::vector<CameraReport> cameras;
};

/// 0 = nothing is wrong, 1 = there are problems, 2 = it cannot be read.
int exitStatus(const InspectionReport& report);

/// One line each: images, time, exposure, calibration, light, motion.
std::vector<std::string> describe(const CameraFacts& facts);

/// The commands that run the odometry over it, with the options that suit it. Lines of YAML, for a file that they name,
/// where options have no argument of their own.
struct Commands {
  std::vector<std::string> options_yaml;
  std::vector<std::string> lines;
};
Commands commandsFor(const InspectionReport& report, const CameraReport& camera);

/// For people.
void print(const InspectionReport& report, std::ostream& out);

}  // namespace mba_vo
