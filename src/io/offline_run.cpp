#include "mba_vo/io/offline_run.h"

#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "mba_vo/io/photometric_files.h"
#include "mba_vo/odometry/live_simulation.h"

namespace mba_vo {
namespace {

constexpr double kSecondsPerMillisecond = 1e-3;
constexpr double kNoticeableExposure = 0.1;  // of its logarithm

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

/// An exposure that is set for all images is not to be corrected.
OdometryConfig believing(const OfflineOptions& options) {
  OdometryConfig config = options.config;
  if (options.exposure) config.tracker.estimate_exposure = false;
  return config;
}

std::unique_ptr<OdometryRun> makeRun(const OfflineOptions& options) {
  const PhotometricCalibration photometric = loadPhotometricCalibration(options.config.image);
  if (options.live) return std::make_unique<LiveSimulation>(believing(options), *options.live, photometric);
  return std::make_unique<Odometry>(believing(options), options.reference_delay_frames, photometric);
}

PinholeCamera pinholeOf(const CameraCalibration& c) { return {c.width, c.height, c.fx, c.fy, c.cx, c.cy}; }

bool differNoticeably(const ExposureCorrection& a, const ExposureCorrection& b) {
  if (a.missing.has_value() != b.missing.has_value()) return true;
  const auto differ = [](double x, double y) { return std::abs(std::log(x / y)) > kNoticeableExposure; };
  return differ(a.factor, b.factor) || (a.missing && differ(*a.missing, *b.missing));
}

/// Takes image after image through the odometry and keeps account of what becomes of them.
class Run {
 public:
  Run(const CameraCalibration& calibration, const OfflineOptions& options)
      : known_(options.known),
        exposure_(options.exposure),
        exposure_correction_(options.exposure_correction),
        unknown_exposure_(options.config.tracker.unknown_exposure),
        camera_(pinholeOf(calibration)),
        odometry_(makeRun(options)) {
    odometry_->setCalibration(calibration, options.known);
    if (options.map) odometry_->beginIn(options.map);
  }

  void process(CameraImage image, OfflineResult& result) {
    image.exposure = exposureOf(image);
    account([&] { return odometry_->process(image); }, result);
  }

  void finish(OfflineResult& result) {
    account([&] { return odometry_->finish(); }, result);
  }

  const Mapper& mapper() const { return odometry_->mapper(); }
  CalibrationCorrection correction() const { return mapper().correction().value_or(known_); }
  Machine machine() const { return odometry_->machine(); }
  /// What would make another run a better one.
  bool hasLearnt(const OfflineResult& result) const {
    return isNoticeable(known_.lacks(correction()), camera_) ||
           differNoticeably(result.exposure_correction, exposure_correction_);
  }

 private:
  std::optional<double> exposureOf(const CameraImage& image) const {
    if (exposure_) return exposure_;
    if (image.exposure) return exposure_correction_.factor * *image.exposure;
    return exposure_correction_.missing;
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

  template <typename Work>
  void account(const Work& work, OfflineResult& result) {
    double processing = 0.0;  // [s]
    const OdometryResult done = [&] {
      const Stopwatch stopwatch(processing);
      return work();
    }();
    double building = 0.0;  // [s]
    for (const PublishedImage& image : done.images) {
      if (image.step.contradicts_calibration) {
        throw std::runtime_error("image " + std::to_string(image.step.sequence) + ": " + image.step.reason);
      }
      building += kSecondsPerMillisecond * image.step.build_ms;
    }
    const double mapping = kSecondsPerMillisecond * done.mapping_ms;
    result.times.frame_build += building;
    result.times.mapping += mapping;
    result.times.tracking += processing - mapping - building;
    result.log.add(done);
    noteExposures(done, result);
  }

  void noteExposures(const OdometryResult& done, OfflineResult& result) const {
    for (const TrackedFrameConstPtr& late : done.late) note(*late, result);
    for (const PublishedImage& image : done.images) {
      if (!image.step.message.tracked) continue;
      note(*image.step.message.tracked, result);
      result.overlay = image.step.message.tracked->frame->overlay;
      if (result.exposure.used) {
        // What varies is followed from image to image; no one number is to be told in its place.
        result.exposure_correction = result.exposure.varies
                                         ? exposure_correction_
                                         : learnt(image.step.exposure.has_value(), result.exposure.ratio);
      }
    }
  }

  static void note(const TrackedFrame& tracked, OfflineResult& result) {
    if (std::isfinite(tracked.exposure_estimate.log_sigma)) result.exposure = tracked.exposure_estimate;
  }

  CalibrationCorrection known_;
  std::optional<double> exposure_;  // of all images [s]
  ExposureCorrection exposure_correction_;
  double unknown_exposure_;  // assumed at first [s]
  PinholeCamera camera_;
  std::unique_ptr<OdometryRun> odometry_;
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
      std::optional<CameraImage> image = reader.next();
      processor_begin += processorSeconds() - before;
      return image;
    };
    while (result.skipped < options.skip && reader.skip()) progress(++result.skipped);
    const std::size_t most = options.frames > 0 ? options.frames : std::numeric_limits<std::size_t>::max();
    for (std::size_t taken = 0; taken < most;) {
      std::optional<CameraImage> image = load();
      if (!image) break;
      run.process(std::move(*image), result);
      progress(result.skipped + ++taken);
      if (taken == options.stop_if_learnt_within && run.hasLearnt(result)) break;
    }
    run.finish(result);
    const std::size_t processed = result.log.frames().size();
    result.stopped_to_restart = run.hasLearnt(result) && processed <= options.stop_if_learnt_within;
    result.times.cpu = processorSeconds() - processor_begin;
  }
  result.correction = run.correction();
  result.settled_correction = run.mapper().settledCorrection();
  SmoothedTrajectory smoothed = run.mapper().smoothedTrajectory();
  result.trajectory = std::move(smoothed.entries);
  result.loops = std::move(smoothed.loops);
  result.points = run.mapper().points();
  if (options.keep_map) result.map = run.mapper().savedMap();
  result.deblurring = run.mapper().deblurCounts();
  result.machine = run.machine();
  result.log.settle(result.trajectory);
  return result;
}

}  // namespace mba_vo
