#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// One row of the written trajectory: where a frame ended up after all optimisation so far.
struct TrajectoryEntry {
  std::uint64_t frame_sequence = 0;
  std::int64_t stamp_ns = 0;
  std::int64_t mid_exposure_ns = 0;
  MapId map_id = 0;
  ExposureTrajectory trajectory;  // relative to the map
};

/// What inserting one keyframe cost [ms], by stage.
struct KeyframeReport {
  KeyframeId keyframe_id = 0;
  std::uint64_t frame_sequence = 0;
  std::int64_t mid_exposure_ns = 0;
  double blur_length_px = 0.0;
  int points = 0;               // active points in the window afterwards
  int residuals = 0;            // in the last optimisation
  double rms = 0.0;             // of the window's residuals [grey levels]
  double depth_search_ms = 0.0;   // spent on frames since the last keyframe
  double activation_ms = 0.0;
  double deblur_ms = 0.0;
  double optimisation_ms = 0.0;
  double marginalisation_ms = 0.0;
  double selection_ms = 0.0;
  double total_ms = 0.0;
};

/// A point of the map for display.
struct MapPoint {
  Eigen::Vector3d position_map;  // [m], up to the monocular scale
  float intensity = 0.0F;        // [grey levels]
  KeyframeId keyframe_id = 0;
};

/// What one call of Mapper::process produced.
struct MapperOutput {
  ReferenceConstPtr reference;              // new snapshot for the tracker, or null
  std::optional<KeyframeReport> keyframe;   // set if the frame became a keyframe
  std::string message;                      // what happened, for the log and the status; may be empty
};

/// Takes every TrackedFrame, initialises the map, refines depths, inserts keyframes, optimises the window and owns the
/// trajectory store. Not thread-safe: one thread calls it.
class Mapper {
 public:
  explicit Mapper(const MapperConfig& config);
  ~Mapper();
  Mapper(const Mapper&) = delete;
  Mapper& operator=(const Mapper&) = delete;

  MapperOutput process(const TrackedFrameConstPtr& frame);

  /// Forgets the map; the trajectory store keeps the poses found so far. The next map gets a new map id.
  void reset();

  /// All frames with a measured pose, by time, each re-expressed with its keyframe's newest pose.
  std::vector<TrajectoryEntry> trajectory() const;
  /// Points of the active window and, up to MapperConfig::max_display_points, of marginalised keyframes.
  std::vector<MapPoint> points() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mba_vo
