#pragma once

#include <mutex>
#include <string>

#include <mba_vo/MapperStatus.h>
#include <mba_vo/TrackedFrameSummary.h>
#include <ros/node_handle.h>

#include "mba_vo/mapping/mapper.h"

namespace mba_vo {

/// Counts what happens to every tracked frame and tells it on the latched topic `mapper/status`. Thread-safe.
class MapperStatusReporter {
 public:
  explicit MapperStatusReporter(ros::NodeHandle& nh);

  void frameReceived(const TrackedFrameSummary& summary);
  void frameShed();
  void frameUnusable(const std::string& reason);
  void frameProcessed(const TrackedFrame& frame, bool stale);
  void inPhase(MappingPhase phase);
  void mapped(const MapperOutput& output);
  void keyframesDeblurred(const DeblurCounts& counts);
  /// Something was thrown while a frame was worked on.
  void failed(const std::string& what);
  void wasReset(const std::string& reason);
  void publish(std::size_t queue_bytes);
  MapperStatus snapshot() const;

 private:
  mutable std::mutex mutex_;
  MapperStatus status_;
  std::uint64_t session_ = 0;
  std::uint64_t next_number_ = 0;
  ros::Publisher publisher_;
};

}  // namespace mba_vo
