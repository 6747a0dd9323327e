#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mba_vo/geometry/sim3.h"
#include "mba_vo/pose_graph/depth_ratio.h"
#include "mba_vo/pose_graph/loop_keyframe.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

/// A keyframe beside one of the two that are compared, whose images took no part in finding how these stand to each
/// other.
struct LoopWitness {
  ArchivedKeyframeConstPtr keyframe;
  SE3 T_beside_keyframe;   // relative to the one it is beside, by odometry
  bool beside_old = true;  // the older of the two; else the newer one
};

/// What became of the comparison of two keyframes.
struct LoopVerdict {
  std::string rejected_because;              // empty: they show one place
  Sim3 S_old_new;                            // in each one's own unit of length
  Matrix7 covariance = Matrix7::Zero();      // of its right increment
  double pixel_error = 0.0;                  // of the worse direction [px]
  double disagreement_px = 0.0;              // between the two directions
  ScaleEstimate by_depths, by_translations;  // two ways to tell the scale
  int witnesses = 0;                         // other keyframes that agree

  bool accepted() const { return rejected_because.empty(); }
};

/// Finds how two keyframes stand to each other, and with what scale, by blur-aware alignment of each one's image to the
/// other's image and depths. Images of other keyframes must agree. Says why where it refuses.
class LoopVerifier {
 public:
  explicit LoopVerifier(const TrackerConfig& tracker);

  /// `starts`: guesses of T_old_new, the first one that leads somewhere counts.
  LoopVerdict verify(const ArchivedKeyframeConstPtr& older, const ArchivedKeyframeConstPtr& newer,
                     const std::vector<SE3>& starts, const std::vector<LoopWitness>& witnesses) const;

 private:
  struct View {
    ArchivedKeyframeConstPtr keyframe;
    FrameConstPtr frame;
    std::shared_ptr<const Reference> reference;

    explicit View(const ArchivedKeyframeConstPtr& kept);
  };
  TrackedFrame align(const View& reference, const View& frame, const SE3& T_reference_frame, bool is_close) const;
  static ScaleEstimate scaleOf(const SE3& T_old_new, const Matrix6& covariance, const SE3& T_old_new_back,
                               const Matrix6& covariance_back, LoopVerdict& verdict);
  static void fuse(const View& older, const View& newer, const TrackedFrame& forward, const TrackedFrame& backward,
                   LoopVerdict& verdict);
  void hearWitnesses(const View& older, const View& newer, const std::vector<LoopWitness>& witnesses,
                     LoopVerdict& verdict) const;

  double unknown_exposure_;  // [s]
  Tracker tracker_;
};

}  // namespace mba_vo
