#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mba_vo/geometry/calibration_correction.h"
#include "mba_vo/geometry/exposure_trajectory.h"
#include "mba_vo/image/image_pyramid.h"

namespace mba_vo {

using MapId = std::uint32_t;
using KeyframeId = std::uint32_t;

struct ReferenceId {
  MapId map_id = 0;
  KeyframeId keyframe_id = 0;
  std::uint32_t revision = 0;  // counts the references emitted for this keyframe
  bool operator==(const ReferenceId& o) const {
    return map_id == o.map_id && keyframe_id == o.keyframe_id && revision == o.revision;
  }
};

/// A point of the reference with known depth.
struct ReferencePoint {
  Eigen::Vector2f pixel;  // at level 0 [px]
  float inverse_depth;    // z^-1 in the reference camera [1/m]
  float variance;         // of the inverse depth [1/m^2]
};

/// Affine brightness B = exp(a) I + b of an image relative to the map [a: log gain, b: grey levels].
struct AffineBrightness {
  double a = 0.0;
  double b = 0.0;
};

/// Where the mapper believes a certain frame to be, given to a tracker that has no prior of its own (after
/// initialisation or relocalisation).
struct TrackingHint {
  std::uint64_t frame_sequence = 0;
  std::int64_t mid_exposure_ns = 0;
  ExposureTrajectory trajectory;  // relative to the reference
};

/// Why the mapper sends a reference, and what the tracker makes of it.
enum class ReferenceCause {
  kMapBegins,     // the first of a map; the hint tells of a frame of the past, those after it are tracked from there
  kKeyframe,      // a new keyframe, or the newest one after the window has been optimised with it
  kSharperImage,  // the keyframe in use has a better image
  kFoundAgain,    // the tracker was lost; the hint tells where the mapper has found one of its frames
  kSentAgain,     // the tracker has no reference of this map; the hint tells of the last frame that had
  kMapClosed      // the map has been given up, `closed_because`; nothing can be tracked with this
};

const char* toString(ReferenceCause cause);

/// Immutable snapshot of the map that the tracker aligns to: mapper -> tracker.
struct Reference {
  ReferenceCause cause = ReferenceCause::kKeyframe;
  ReferenceId id;
  std::int64_t mid_exposure_ns = 0;  // of its image [ns]
  SE3 T_map_reference;               // as the window has it
  SE3 T_corrected_map;               // by what closed loops have moved all that the window has; published poses have it
  std::shared_ptr<const ImagePyramid> pyramid;
  Vector6 image_xi = Vector6::Zero();                       // motion blur left in the image, 0 = sharp [m, rad]
  BodyMotion motion;                                        // while the rows of a rolling shutter are read
  AffineBrightness brightness;                              // of the reference image
  CalibrationCorrection image_correction;                   // of the calibration, that its image was made with
  CalibrationCorrection correction;                         // that new images should be made with
  std::optional<CalibrationCorrection> settled_correction;  // the last one that was right for a while
  std::vector<ReferencePoint> points;
  std::map<KeyframeId, SE3> T_map_keyframe;  // the window's poses at the same moment
  std::optional<TrackingHint> hint;          // where the cause says so
  std::optional<double> exposure;            // of its image [s]; nullopt = unknown
  double exposure_log_sigma = 0.0;           // standard deviation of its logarithm; 0 = it came with the image
  std::string doubt;                         // why poses of this map are not to be relied on; empty if they are
  std::string closed_because;                // with kMapClosed
  bool metric = false;                       // the unit of length is the metre; else it is arbitrary
  bool at_infinity = false;  // no depths are known and the points' mean nothing: only rotation can be tracked
};

using ReferenceConstPtr = std::shared_ptr<const Reference>;

}  // namespace mba_vo
