#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "mba_vo/mapping/mapper.h"
#include "mba_vo/odometry/tracking_loop.h"

namespace mba_vo {

/// What happened to one input frame, or after the last one.
struct OdometryResult {
  TrackedFrameConstPtr tracked;            // null after the last frame
  std::vector<MapperOutput> mapping;       // one for each result that went to the mapper
  std::vector<TrackedFrameConstPtr> late;  // further results of earlier frames, which had to wait for a reference
  double mapping_ms = 0.0;
};

/// Tracker and mapper called in turn, deterministically: the offline pipeline. The mapper's references are adopted
/// `reference_delay_frames` after the frame that caused them; that holds also among frames that had to wait for the
/// first reference and are tracked late.
class Odometry {
 public:
  /// Throws std::invalid_argument for a negative delay.
  Odometry(const OdometryConfig& config, int reference_delay_frames);

  /// Every frame gives exactly one result; its `tracked` is never null.
  OdometryResult process(const FrameConstPtr& frame);

  /// To be called after the last frame: does what has been put off. No reference is waited for any longer.
  OdometryResult finish();

  /// What the images say that the calibration lacks: for the images to come.
  CalibrationCorrection correction() const { return mapper_.correction(); }
  /// Begins anew, with another map; the trajectory keeps what was found so far.
  void reset();

  std::vector<TrajectoryEntry> trajectory() const { return mapper_.trajectory(); }
  std::vector<MapPoint> points() const { return mapper_.points(); }
  DeblurCounts deblurCounts() const { return mapper_.deblurCounts(); }

 private:
  bool takeDueReferences(std::uint64_t frame);
  std::uint64_t nextFrame() const;  // to be tracked
  void trackWaiting(OdometryResult& result, bool at_end);
  void map(const TrackedFrameConstPtr& tracked, std::uint64_t frame, OdometryResult& result);

  struct PendingReference {
    std::uint64_t due_frame;  // adopted before this frame, counted from 0
    ReferenceConstPtr reference;
  };
  TrackingLoop tracking_;
  Mapper mapper_;
  int reference_delay_frames_;
  std::uint64_t frames_ = 0;  // processed so far
  std::deque<PendingReference> pending_;
};

}  // namespace mba_vo
