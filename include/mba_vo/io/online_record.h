#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "mba_vo/io/run_log.h"
#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {

/// Writes down what is published while it is published: online_trajectory.txt,
/// online_exposure_trajectory.txt, online_odometry.txt and frames.csv of a live run, with a row for every image, by
/// their numbers. What the mapper finds out later is not in these files.
class OnlineRecord {
 public:
  /// Makes the folder if need be and replaces the files of an earlier run. Throws std::runtime_error naming what cannot
  /// be written.
  explicit OnlineRecord(const std::string& folder);

  /// The first result of an image. Throws std::runtime_error naming the folder and the reason if that fails: the disk
  /// is full. Nothing more is written then.
  void add(const PublishedImage& image);
  /// An image that was shed. It is written before the next result of a later image. May be called from any thread.
  void addShed(const TrackerStep& step);
  /// Writes what was shed last. Throws as add() does.
  void finish();

 private:
  void writeShed(std::uint64_t end);
  std::optional<TrackerStep> takeShed(std::uint64_t end);
  void write(const FrameRecord& record);

  std::string folder_;
  std::ofstream trajectory_file_, exposures_file_, odometry_file_, frames_file_;
  std::unique_ptr<PoseLines> trajectory_, odometry_;
  std::unique_ptr<ExposureLines> exposures_;
  bool failed_ = false;
  std::mutex shed_mutex_;
  std::map<std::uint64_t, TrackerStep> shed_;  // by number, not written yet
};

}  // namespace mba_vo
