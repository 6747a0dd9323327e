#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "mba_vo/odometry/machine_meter.h"
#include "mba_vo/odometry/mapper_pipeline.h"
#include "mba_vo/odometry/tracker_pipeline.h"

namespace mba_vo {

/// An image's first result with the time at which it was there.
struct PublishedImage {
  TrackerStep step;
  double published = 0.0;  // on the clock of step.arrival [s]
};

/// What happened since the last call.
struct OdometryResult {
  std::vector<PublishedImage> images;      // that have their first results, or were rejected
  std::vector<MapperOutput> mapping;       // one for each result that went to the mapper
  std::vector<TrackedFrameConstPtr> late;  // further results of earlier frames, which had to wait for a reference
  double mapping_ms = 0.0;

  /// Of the last image; null if there is none, or it was rejected.
  TrackedFrameConstPtr tracked() const { return images.empty() ? nullptr : images.back().step.message.tracked; }
};

/// Both halves of the pipeline in one loop. How time passes there is up to the derived class.
class OdometryRun {
 public:
  virtual ~OdometryRun() = default;

  /// Throws std::invalid_argument naming what is wrong with the calibration. `known`: how it is to be corrected, as
  /// earlier runs have found. To be called before the first image.
  virtual void setCalibration(const CameraCalibration& calibration, const CalibrationCorrection& known) = 0;
  /// Goes on in a map of an earlier run (Mapper::beginIn). To be called before the first image.
  virtual void beginIn(std::shared_ptr<const SavedMap> map) = 0;
  /// The next image, which comes in now.
  virtual OdometryResult process(const CameraImage& image) = 0;
  /// After the last image: does what waits.
  virtual OdometryResult finish() = 0;
  /// Knows the map and the trajectory.
  virtual const Mapper& mapper() const = 0;
  /// The machine that it ran on, as measured or as described.
  virtual Machine machine() const = 0;
};

/// The ideal machine: no work takes any time, and every frame is dealt with before the next one comes. The mapper's
/// references are adopted `reference_delay_frames` after the frame that caused them; that holds also among frames that
/// had to wait for the first reference and are tracked late.
class Odometry : public OdometryRun {
 public:
  /// Throws std::invalid_argument for a negative delay.
  Odometry(const OdometryConfig& config, int reference_delay_frames, const PhotometricCalibration& photometric = {});

  void setCalibration(const CameraCalibration& calibration, const CalibrationCorrection& known) override {
    tracker_.setCalibration(calibration, known);
  }
  void beginIn(std::shared_ptr<const SavedMap> map) override { mapper_.beginIn(std::move(map)); }
  OdometryResult process(const CameraImage& image) override;
  /// Every frame gives exactly one result.
  OdometryResult process(const FrameConstPtr& frame);
  OdometryResult finish() override;
  const Mapper& mapper() const override { return mapper_.mapper(); }
  Machine machine() const override { return meter_.machine(); }

  /// Begins anew, with another map; the trajectory keeps what was found so far.
  void reset();
  std::vector<TrajectoryEntry> trajectory() const { return mapper().finishedTrajectory(); }

 private:
  struct PendingReference {
    std::uint64_t due_frame;  // adopted before this frame, counted from 0
    MapperMessage message;
  };

  OdometryResult processQueued(OdometryResult result);
  bool deliverDueReferences(std::uint64_t frame);
  std::uint64_t nextFrame() const;  // to be tracked
  void trackWaiting(OdometryResult& result, bool at_end);
  void map(const TrackerMessage& message, std::uint64_t frame, OdometryResult& result);
  std::optional<TrackerStep> trackerStep(bool at_end);
  std::optional<MapperStep> mapperStep();

  TrackerPipeline tracker_;
  MachineMeter meter_;
  MapperPipeline mapper_;
  int reference_delay_frames_;
  std::uint64_t frames_ = 0;  // processed so far
  std::deque<PendingReference> pending_;
};

}  // namespace mba_vo
