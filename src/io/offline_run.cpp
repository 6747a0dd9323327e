#include "mba_vo/io/offline_run.h"

#include <chrono>
#include <cmath>
#include <stdexcept>

#include "mba_vo/io/photometric_files.h"
#include "mba_vo/odometry/input_guard.h"

namespace mba_vo {
namespace {

/// Adds the time of its life to `seconds`.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds), begin_(Clock::now()) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(Clock::now() - begin_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point begin_;
};

FrameBuilder makeFrameBuilder(const CameraCalibration& calibration, const FrameBuilderConfig& config) {
  return {calibration, loadPhotometricCalibration(config.response_file, config.vignette_file), config};
}

/// An exposure that is set for all images is not to be corrected.
OdometryConfig believing(const OfflineOptions& options) {
  OdometryConfig config = options.config;
  if (options.exposure) config.tracker.estimate_exposure = false;
  return config;
}

/// Takes image after image through guard, frame builder and odometry.
class Run {
 public:
  Run(const CameraCalibration& calibration, const OfflineOptions& options)
      : start_(options.config.mapper.start_correction),
        exposure_(options.exposure),
        builder_(makeFrameBuilder(calibration, options.config.image)),
        odometry_(believing(options), options.reference_delay_frames) {
    builder_.correct(odometry_.correction());
  }

  void process(const SequenceImage& image, OfflineResult& result) {
    if (image.image.empty()) {
      result.log.addRejected(image, image.problem);
      return;
    }
    const InputVerdict verdict = guard_.check(image.stamp_ns, exposure_ ? exposure_ : image.exposure);
    if (!verdict.accepted) {
      result.log.addRejected(image, verdict.reason);
      return;
    }
    const FrameConstPtr frame = build(image, verdict.exposure, result.times.frame_build);
    double processing = 0.0;  // [s]
    const OdometryResult odometry = [&] {
      const Stopwatch stopwatch(processing);
      return odometry_.process(frame);
    }();
    account(odometry, processing, verdict.reason, result);
    builder_.correct(odometry_.correction());
  }

  void finish(OfflineResult& result) {
    double processing = 0.0;  // [s]
    const OdometryResult odometry = [&] {
      const Stopwatch stopwatch(processing);
      return odometry_.finish();
    }();
    account(odometry, processing, "", result);
  }

  CalibrationCorrection correction() const { return odometry_.correction(); }
  bool corrected() const { return odometry_.correction() != start_; }
  std::vector<TrajectoryEntry> trajectory() const { return odometry_.trajectory(); }

 private:
  static void note(const TrackedFrame& tracked, OfflineResult& result) {
    if (std::isfinite(tracked.exposure_estimate.log_sigma)) result.exposure = tracked.exposure_estimate;
  }

  static void account(const OdometryResult& odometry, double processing, const std::string& warning,
                      OfflineResult& result) {
    constexpr double kSecondsPerMillisecond = 1e-3;
    const double mapping = kSecondsPerMillisecond * odometry.mapping_ms;
    result.times.mapping += mapping;
    result.times.tracking += processing - mapping;
    result.log.add(odometry, warning);
    for (const TrackedFrameConstPtr& late : odometry.late) note(*late, result);
    if (odometry.tracked) note(*odometry.tracked, result);
  }

  FrameConstPtr build(const SequenceImage& image, const std::optional<double>& exposure, double& seconds) const {
    const Stopwatch stopwatch(seconds);
    try {
      return builder_.build(image.image, image.sequence, image.stamp_ns, image.mid_exposure_ns, exposure);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error("image " + std::to_string(image.sequence) + ": " + error.what());
    }
  }

  CalibrationCorrection start_;
  std::optional<double> exposure_;  // [s]
  InputGuard guard_;
  FrameBuilder builder_;
  Odometry odometry_;
};

}  // namespace

OfflineResult runOffline(SequenceReader& reader, const OfflineOptions& options, const ProgressCallback& progress) {
  OfflineResult result;
  Run run(reader.calibration(), options);
  {
    const Stopwatch total(result.times.total);
    const auto load = [&] {
      const Stopwatch stopwatch(result.times.load);
      return reader.next();
    };
    for (std::size_t done = 1; const std::optional<SequenceImage> image = load(); ++done) {
      if (done <= options.skip) {
        ++result.skipped;
      } else {
        run.process(*image, result);
      }
      progress(done);
      if (done == options.skip + options.stop_if_corrected_within && run.corrected()) break;
    }
    run.finish(result);
    const std::size_t processed = result.log.frames().size();
    result.stopped_for_calibration = run.corrected() && processed <= options.stop_if_corrected_within;
  }
  result.correction = run.correction();
  result.trajectory = run.trajectory();
  result.log.settle(result.trajectory);
  return result;
}

}  // namespace mba_vo
