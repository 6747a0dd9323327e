#pragma once

#include <fstream>
#include <memory>
#include <string>

#include "mba_vo/io/run_log.h"
#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {

/// Writes down what is published while it is published: online_trajectory.txt, online_odometry.txt and frames.csv of a
/// live run. What the mapper finds out later is not in these files.
class OnlineRecord {
 public:
  /// Makes the folder if need be and replaces the files of an earlier run. Throws std::runtime_error naming what cannot
  /// be written.
  explicit OnlineRecord(const std::string& folder);

  /// Throws std::runtime_error naming the folder and the reason if that fails: the disk is full.
  void add(const PublishedImage& image);

 private:
  std::string folder_;
  std::ofstream trajectory_file_, odometry_file_, frames_file_;
  std::unique_ptr<PoseLines> trajectory_, odometry_;
};

}  // namespace mba_vo
