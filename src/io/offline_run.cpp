#include "mba_vo/io/offline_run.h"

#include <chrono>
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

FrameBuilder makeFrameBuilder(const CameraCalibration& calibration, const FrameBuilderConfig& config) {
  return {calibration, loadPhotometricCalibration(config.response_file, config.vignette_file), config};
}

/// Takes image after image through guard, frame builder and odometry.
class Run {
 public:
  Run(const CameraCalibration& calibration, const OfflineOptions& options)
      : exposure_(options.exposure),
        builder_(makeFrameBuilder(calibration, options.config.image)),
        odometry_(options.config, options.reference_delay_frames) {}

  void process(const SequenceImage& image, OfflineResult& result) {
    if (image.image.empty()) {
      result.log.addRejected(image, image.problem);
      return;
    }
    InputVerdict verdict = guard_.check(image.stamp_ns, exposure_ ? exposure_ : image.exposure);
    if (verdict.clock_restarted) {
      odometry_.reset();
      guard_.reset();
      const std::string restart = verdict.reason + ": taken for a new start";
      verdict = guard_.check(image.stamp_ns, exposure_ ? exposure_ : image.exposure);
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
    account(odometry, processing, verdict.reason, result);
  }

  void finish(OfflineResult& result) {
    double processing = 0.0;  // [s]
    const OdometryResult odometry = [&] {
      const Stopwatch stopwatch(processing);
      return odometry_.finish();
    }();
    account(odometry, processing, "", result);
  }

  std::vector<TrajectoryEntry> trajectory() const { return odometry_.trajectory(); }

 private:
  static void account(const OdometryResult& odometry, double processing, const std::string& warning,
                      OfflineResult& result) {
    constexpr double kSecondsPerMillisecond = 1e-3;
    const double mapping = kSecondsPerMillisecond * odometry.mapping_ms;
    result.times.mapping += mapping;
    result.times.tracking += processing - mapping;
    result.log.add(odometry, warning);
  }

  FrameConstPtr build(const SequenceImage& image, const std::optional<double>& exposure, double& seconds) const {
    const Stopwatch stopwatch(seconds);
    try {
      return builder_.build(image.image, image.sequence, image.stamp_ns, image.mid_exposure_ns, exposure);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error("image " + std::to_string(image.sequence) + ": " + error.what());
    }
  }

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
    while (result.skipped < options.skip && reader.skip()) progress(++result.skipped);
    const std::size_t most = options.frames > 0 ? options.frames : std::numeric_limits<std::size_t>::max();
    for (std::size_t taken = 0; taken < most;) {
      const std::optional<SequenceImage> image = load();
      if (!image) break;
      run.process(*image, result);
      progress(result.skipped + ++taken);
    }
    run.finish(result);
  }
  result.trajectory = run.trajectory();
  result.log.settle(result.trajectory);
  return result;
}

}  // namespace mba_vo
