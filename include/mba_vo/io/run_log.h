#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "mba_vo/io/sequence.h"
#include "mba_vo/odometry/odometry.h"

namespace mba_vo {

/// The pose that was published for an image when it was published.
struct OnlinePose {
  MapId map = 0;
  ExposureTrajectory in_map;             // camera to map
  SE3 T_odom_camera;                     // at mid-exposure
  Matrix6 covariance = Matrix6::Zero();  // of T_odom_camera's right increment (translation [m], rotation [rad])
  Matrix6 velocity_covariance = Matrix6::Zero();
};

/// What became of one input image: a row of frames.csv. One is kept for each image of a run, so it is small.
struct FrameRecord {
  std::uint64_t sequence = 0;
  std::int64_t stamp_ns = 0;         // as recorded [ns]
  std::int64_t mid_exposure_ns = 0;  // [ns]
  std::optional<double> exposure;    // given to the tracker [s]; nullopt = unknown
  std::string_view status;  // a literal: TRACKING, DEGRADED: it has a pose; INITIALIZING, LOST, REJECTED: it has none;
                            // REPEATED: that of another image
  std::string reason;
  std::string message;                  // of the mapper
  std::optional<MapId> map;             // of its pose
  std::optional<float> blur_length_px;  // [px]; these four only if the tracker itself found the pose
  std::optional<int> points_used;
  std::optional<float> residual_rms;  // [grey levels]
  std::optional<float> pixel_error;   // [px]
  float tracking_ms = 0.0F;
  float mapping_ms = 0.0F;
  double arrival = 0.0;              // of the image, on the run's clock [s]
  std::optional<double> published;   // its first pose, or its orientation alone, on the same clock [s]
  std::string_view online_status;    // then: a status as above, ORIENTATION or SHED
  std::optional<OnlinePose> online;  // nullopt: no pose was published
  bool metric = false;               // that map's unit of length is the metre

  bool hasPose() const { return map.has_value(); }
};

/// As far as it is known when the image has its first result.
FrameRecord recordOf(const PublishedImage& image);

/// Collects one record per input image. The final status is known only once the final trajectory is: frames may be
/// tracked backwards after initialisation, and a map may be given up.
class RunLog {
 public:
  /// What the mapper did goes to the row of the last image.
  void add(const OdometryResult& result);
  /// Brings every status in line with the final trajectory. Call once, at the end.
  void settle(const std::vector<TrajectoryEntry>& trajectory);

  const std::vector<FrameRecord>& frames() const { return frames_; }
  const std::vector<KeyframeReport>& keyframes() const { return keyframes_; }

 private:
  void addLate(const TrackedFrame& late);

  std::vector<FrameRecord> frames_;
  std::vector<KeyframeReport> keyframes_;
  std::set<MapId> metric_maps_;
};

/// Counts over all records, after settle().
struct FrameCounts {
  std::size_t frames = 0;
  std::size_t tracked = 0;                       // have a pose in the final trajectory
  std::size_t repeated = 0;                      // show an earlier image again, and have no pose of their own
  std::size_t dropped = 0;                       // have none
  std::size_t dropped_after_initialization = 0;  // after the first frame with a pose
  std::size_t rejected = 0;
  std::size_t maps = 0;
  std::size_t metric_maps = 0;  // of these, in metres
};

FrameCounts countFrames(const std::vector<FrameRecord>& frames);

}  // namespace mba_vo
