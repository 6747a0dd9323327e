#pragma once

#include <cstdint>
#include <optional>

#include "mba_vo/odometry/machine.h"
#include "mba_vo/odometry/odometry.h"

namespace mba_vo {

/// A live run in simulated time: images arrive at their stamps, every step of the two halves takes the time that it
/// takes on the machine described, and what comes too late comes too late. The tracker has a core when it needs one;
/// the mapper works with what is left, in its parallel loops with all of it. The same images always go the same way.
class LiveSimulation : public OdometryRun {
 public:
  LiveSimulation(const OdometryConfig& config, const Machine& machine, const PhotometricCalibration& photometric = {});

  void setCalibration(const CameraCalibration& calibration, const CalibrationCorrection& known) override {
    tracker_.setCalibration(calibration, known);
  }
  void beginIn(std::shared_ptr<const SavedMap> map) override { mapper_.beginIn(std::move(map)); }
  /// What has been done until the image arrives; its own result comes with a later call.
  OdometryResult process(const CameraImage& image) override;
  OdometryResult finish() override;
  const Mapper& mapper() const override { return mapper_.mapper(); }
  Machine machine() const override { return machine_; }

 private:
  struct TrackerWork {
    TrackerStep step;
    double left = 0.0;  // [s] of one core
  };
  struct MapperWork {
    MapperStep step;
    StepTime left;
    double& part() { return left.serial > 0.0 ? left.serial : left.parallel; }  // that is being done
  };

  void runUntil(double time, OdometryResult& result);
  void startWork();
  void adoptSize(const PinholeCamera& camera);
  double trackerRate() const;
  double mapperRate() const;
  double timeOfNextEvent(double latest);
  void work(double seconds);
  void endWork(OdometryResult& result);
  void endTracking(OdometryResult& result);

  TrackerPipeline tracker_;
  MapperPipeline mapper_;
  Machine machine_;
  std::optional<std::int64_t> first_ns_;  // mid-exposure of the first image, when time begins
  double now_ = 0.0;                      // [s]
  bool at_end_ = false;
  int largest_width_ = 0;     // of the images that are worked on [px]
  double size_factor_ = 1.0;  // on all times, by the size of the newest
  std::optional<TrackerWork> tracking_;
  std::optional<MapperWork> mapping_;
};

}  // namespace mba_vo
