#pragma once

#include <string>
#include <vector>

#include "mba_vo/evaluation/pose_file.h"

namespace mba_vo {

struct GroundTruthOptions {
  std::string calibration_file;  // that tells where the camera is on the body; empty = that of the recording
  std::string camera;            // of several (cam0, cam1, ...); empty = cam0
};

/// True poses of the camera, sorted by time. `path` is one of
///   - a file that readPoseFile reads (TUM RGB-D, ETH3D, TUM-mono, and what this project writes);
///   - data.csv of an ASL folder (EuRoC: state_groundtruth_estimate0, vicon0; TUM-VI: mocap0). Its poses are those of a
///     body or of a sensor on it; they are moved into the camera by the T_BS of both, or by Kalibr's T_cam_imu;
///   - the folder of a recording of any form that openDataset knows: the truth that lies in it. Poses of 7-Scenes
///     (frame-000000.pose.txt) are those of its depth camera, at 30 Hz.
/// Throws std::runtime_error naming file and line of what is missing or wrong.
std::vector<PoseRecord> readGroundTruth(const std::string& path, const GroundTruthOptions& options = {});

/// Whether there is any in the folder of a recording, for readGroundTruth.
bool hasGroundTruth(const std::string& folder);

}  // namespace mba_vo
