#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include <mba_vo/MapperStatus.h>
#include <mba_vo/Status.h>
#include <ros/node_handle.h>

#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// What the inputs lack at present.
struct InputProblem {
  std::string text;     // empty = nothing
  bool silent = false;  // no images come
};

/// Counts what happens to every image and tells it on the latched topic `status`. Thread-safe.
class StatusReporter {
 public:
  explicit StatusReporter(ros::NodeHandle& nh);

  void imageReceived(std::uint64_t missing_before);
  /// Every image that was received ends in exactly one of these four, or the tracker failed on it.
  void imageShed(std::int64_t stamp_ns);
  void imageRejected(std::int64_t stamp_ns, const std::string& reason);
  void imageRepeated(std::int64_t stamp_ns, const std::string& reason);
  void imageTracked(const TrackedFrame& tracked, const std::string& exposure_source, bool tf_predicted);

  /// Something was thrown. `on_image`: while an image was worked on, which has no result now.
  void trackerFailed(const std::string& what, bool on_image);
  void mapperSaid(const MapperStatus& mapper);
  void referenceAdopted(const Reference& reference);
  void referenceStale();
  void wasReset(const std::string& reason);
  /// Publishes the present state. It is WAITING while no images come, or none of use.
  void publish(const InputProblem& problem, std::size_t queue_bytes);
  Status snapshot() const;

 private:
  void publishLocked(const std::string& reason);

  mutable std::mutex mutex_;
  Status status_;
  std::string rejection_;    // of the newest image, if that was rejected
  bool any_usable_ = false;  // since the last time that the state was published
  ros::Publisher publisher_;
};

}  // namespace mba_vo
