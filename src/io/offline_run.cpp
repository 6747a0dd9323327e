#include "mba_vo/io/offline_run.h"

#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
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

/// Of all threads of the process.
double processorSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

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
        exposure_correction_(options.exposure_correction),
        unknown_exposure_(options.config.tracker.unknown_exposure),
        builder_(makeFrameBuilder(calibration, options.config.image)),
        odometry_(believing(options), options.reference_delay_frames) {
    builder_.correct(odometry_.correction());
  }

  void process(const SequenceImage& image, OfflineResult& result) {
    if (image.image.empty()) {
      result.log.addRejected(image, image.problem);
      return;
    }
    InputVerdict verdict = check(image);
    if (verdict.clock_restarted) {
      odometry_.reset();
      guard_.reset();
      const std::string restart = verdict.reason + ": taken for a new start";
      verdict = check(image);
      verdict.reason = restart;
    }
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
    std::string warning = verdict.reason;
    if (!image.problem.empty()) warning += (warning.empty() ? "" : "; ") + image.problem;
    account(odometry, processing, warning, result);
    if (result.exposure.used) result.exposure_correction = learnt(verdict.exposure.has_value(), result.exposure.ratio);
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
  bool hasLearnt(const OfflineResult& result) const {
    return odometry_.correction() != start_ || !(result.exposure_correction == exposure_correction_);
  }
  std::vector<TrajectoryEntry> trajectory() const { return odometry_.trajectory(); }
  std::vector<MapPoint> points() const { return odometry_.points(); }
  DeblurCounts deblurCounts() const { return odometry_.deblurCounts(); }

 private:
  InputVerdict check(const SequenceImage& image) {
    std::optional<double> exposure = exposure_correction_.missing;
    if (image.exposure) exposure = exposure_correction_.factor * *image.exposure;
    return guard_.check(image.stamp_ns, exposure_ ? exposure_ : exposure);
  }

  ExposureCorrection learnt(bool given, double ratio) const {
    ExposureCorrection correction = exposure_correction_;
    if (given) {
      correction.factor *= ratio;
      if (correction.missing) *correction.missing *= ratio;
    } else {
      correction.missing = ratio * unknown_exposure_;
    }
    return correction;
  }

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
      return builder_.build(image.image, image.sequence, image.stamp_ns, image.mid_exposure_ns, exposure, image.depth);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error("image " + std::to_string(image.sequence) + ": " + error.what());
    }
  }

  CalibrationCorrection start_;
  std::optional<double> exposure_;  // of all images [s]
  ExposureCorrection exposure_correction_;
  double unknown_exposure_;  // assumed at first [s]
  InputGuard guard_;
  FrameBuilder builder_;
  Odometry odometry_;
};

}  // namespace

OfflineResult runOffline(SequenceReader& reader, const OfflineOptions& options, const ProgressCallback& progress) {
  OfflineResult result;
  result.exposure_correction = options.exposure_correction;
  Run run(reader.calibration(), options);
  {
    const Stopwatch total(result.times.total);
    double processor_begin = processorSeconds();
    const auto load = [&] {
      const Stopwatch stopwatch(result.times.load);
      const double before = processorSeconds();
      std::optional<SequenceImage> image = reader.next();
      processor_begin += processorSeconds() - before;
      return image;
    };
    while (result.skipped < options.skip && reader.skip()) progress(++result.skipped);
    const std::size_t most = options.frames > 0 ? options.frames : std::numeric_limits<std::size_t>::max();
    for (std::size_t taken = 0; taken < most;) {
      const std::optional<SequenceImage> image = load();
      if (!image) break;
      run.process(*image, result);
      progress(result.skipped + ++taken);
      if (taken == options.stop_if_learnt_within && run.hasLearnt(result)) break;
    }
    run.finish(result);
    const std::size_t processed = result.log.frames().size();
    result.stopped_to_restart = run.hasLearnt(result) && processed <= options.stop_if_learnt_within;
    result.times.cpu = processorSeconds() - processor_begin;
  }
  result.correction = run.correction();
  result.trajectory = run.trajectory();
  result.points = run.points();
  result.deblurring = run.deblurCounts();
  result.log.settle(result.trajectory);
  return result;
}

}  // namespace mba_vo
