#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "mba_vo/io/run_log.h"
#include "mba_vo/io/sequence.h"
#include "mba_vo/odometry/odometry.h"

namespace mba_vo {

struct OfflineOptions {
  OdometryConfig config;
  std::optional<double> exposure;  // for every image [s], 0 = instantaneous; nullopt = as recorded
  std::size_t skip = 0;            // images left out at the beginning
  int reference_delay_frames = 0;  // from a keyframe to the frame that is first aligned to it
  // Among so many images a correction of the calibration ends the run, at the last of them; 0 = it goes on.
  std::size_t stop_if_corrected_within = 0;
};

/// Wall-clock time by stage [s].
struct StageTimes {
  double load = 0.0;         // reading and decoding images
  double frame_build = 0.0;  // photometric correction, rectification, pyramid
  double tracking = 0.0;
  double mapping = 0.0;
  double total = 0.0;  // of the whole loop
};

struct OfflineResult {
  RunLog log;
  std::vector<TrajectoryEntry> trajectory;
  CalibrationCorrection correction;  // of the calibration, at the end
  StageTimes times;
  std::size_t skipped = 0;
  ExposureEstimate exposure;  // the latest
  bool stopped_for_calibration = false;
  int calibration_restarts = 0;  // of the run, each with a better calibration
};

/// Called after every image with the number of images done.
using ProgressCallback = std::function<void(std::size_t done)>;

/// Runs the odometry over a whole sequence. Every image after the skipped ones gets a record. Throws
/// std::runtime_error or std::invalid_argument naming what is wrong with the sequence or its calibration.
OfflineResult runOffline(SequenceReader& reader, const OfflineOptions& options, const ProgressCallback& progress);

}  // namespace mba_vo
