#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/io/run_log.h"
#include "mba_vo/io/sequence.h"
#include "mba_vo/odometry/machine.h"
#include "mba_vo/odometry/odometry.h"

namespace mba_vo {

/// What is to be done about the exposures of a sequence.
struct ExposureCorrection {
  std::optional<double> missing;  // of images that came without one [s]; nullopt = not known
  double factor = 1.0;            // by which those that came are too short

  bool operator==(const ExposureCorrection& o) const { return missing == o.missing && factor == o.factor; }
};

struct OfflineOptions {
  OdometryConfig config;
  CalibrationCorrection known;             // of the calibration, by earlier runs
  std::optional<double> exposure;          // for every image [s], 0 = instantaneous; nullopt = as recorded
  ExposureCorrection exposure_correction;  // else
  std::size_t skip = 0;                    // images left out at the beginning
  std::size_t frames = 0;                  // images taken after these, 0 = all
  int reference_delay_frames = 0;          // from a keyframe to the frame that is first aligned to it
  std::optional<Machine> live;             // as if it ran live on this machine; nullopt = no work takes any time
  std::shared_ptr<const SavedMap> map;     // of an earlier run, to go on in; null = none
  bool keep_map = false;                   // OfflineResult::map is wanted
  // What is learnt about the camera from so many images ends the run, at the last of them; 0 = it goes on.
  std::size_t stop_if_learnt_within = 0;
};

/// Wall-clock time by stage [s].
struct StageTimes {
  double load = 0.0;         // reading and decoding images
  double frame_build = 0.0;  // photometric correction, rectification, pyramid
  double tracking = 0.0;
  double mapping = 0.0;
  double total = 0.0;  // of the whole loop
  double cpu = 0.0;    // processor time of all threads, all but `load` [core seconds]
};

struct OfflineResult {
  RunLog log;
  std::vector<TrajectoryEntry> trajectory;
  std::vector<LoopTrial> loops;                             // that were looked into
  CalibrationCorrection correction;                         // of the calibration, at the end
  std::optional<CalibrationCorrection> settled_correction;  // the last that was right for a while
  ExposureCorrection exposure_correction;  // that which was given, or, if the images contradict it, as they say
  std::vector<MapPoint> points;            // of the last map
  std::optional<SavedMap> map;             // the last one, if it is wanted and there is one
  cv::Mat1b overlay;                       // 255 where something covers the scene in the images; empty = nowhere
  DeblurCounts deblurring;                 // of the keyframes
  StageTimes times;
  std::size_t skipped = 0;
  bool stopped_to_restart = false;
  int restarts = 0;           // of the run, each with what was learnt about the camera
  ExposureEstimate exposure;  // the latest
  Machine machine;            // that it ran on, as measured, or as described for a live run
};

/// Called after every image with the number of images done.
using ProgressCallback = std::function<void(std::size_t done)>;

/// Runs the odometry over a whole sequence. Every image after the skipped ones gets a record. Throws
/// std::runtime_error or std::invalid_argument naming what is wrong with the sequence or its calibration.
OfflineResult runOffline(SequenceReader& reader, const OfflineOptions& options, const ProgressCallback& progress);

}  // namespace mba_vo
