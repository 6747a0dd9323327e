#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>

#include "mba_vo/initialization/initializer.h"
#include "mba_vo/initialization/initializer_buffer.h"

namespace mba_vo {

/// Begins a map with the depth image of a frame: no parallax is needed, and lengths are metres. The frame's own blur
/// comes from its pose relative to the frames next to it, which must agree with the depths.
class MetricStart {
 public:
  /// `max_wait`: how long a sharper frame is waited for if the first ones with depths are blurred [s].
  MetricStart(double max_wait, int max_corners, const DepthSensorConfig& sensor)
      : max_wait_(max_wait), max_corners_(max_corners), sensor_(sensor) {}

  /// A map, if one of the buffered frames but the newest is good enough; else null.
  std::unique_ptr<InitialMap> attempt(const InitializerBuffer& buffer);
  /// Why the last attempt gave none; empty if there were no depths.
  const std::string& reason() const { return reason_; }
  void reset();

 private:
  bool isCandidate(const BufferedImage& entry) const;
  std::unique_ptr<InitialMap> begin(const InitializerBuffer& buffer, std::size_t index);
  bool addPoints(InitialMap& map);
  bool addPose(const InitializerBuffer& buffer, const ReferenceTracker& tracker, std::size_t index, bool next,
               InitialMap& map);

  double max_wait_;  // [s]
  int max_corners_;
  DepthSensorConfig sensor_;
  std::string reason_;
  std::set<std::int64_t> rejected_;  // mid-exposure times of frames that are no good [ns]
};

}  // namespace mba_vo
