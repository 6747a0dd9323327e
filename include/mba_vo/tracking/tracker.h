#pragma once

#include <optional>
#include <vector>

#include "mba_vo/tracking/alignment_problem.h"
#include "mba_vo/tracking/motion_prior.h"
#include "mba_vo/tracking/reference.h"
#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// Standard deviation of the logarithm of `TrackerConfig::unknown_exposure`, which is only assumed.
inline constexpr double kAssumedExposureSigma = 0.8;

/// Options of the blur-aware tracker. `describe` names every option once, for YAML, ROS parameters and documentation.
struct TrackerConfig {
  int pyramid_levels = 5;
  int max_points = 340;
  int max_iterations = 10;
  double huber_threshold = 9.0;
  double sample_spacing_px = 1.25;
  int max_samples = 64;
  double unknown_exposure = 0.01;
  bool estimate_exposure = true;
  double min_inlier_fraction = 0.35;
  double degraded_inlier_fraction = 0.6;
  double degraded_pixel_error = 1.2;
  double max_pixel_error = 3.0;
  double degraded_expected_error = 1.0;
  int min_patches = 20;
  MotionPriorConfig motion_prior;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("pyramid_levels", c.pyramid_levels, 1, 8, "image pyramid levels");
    v("max_points", c.max_points, 20, 5000, "patches aligned per frame");
    v("max_iterations", c.max_iterations, 1, 100, "Levenberg-Marquardt evaluations per level");
    v("huber_threshold", c.huber_threshold, 0.1, 255.0, "largest Huber threshold of the residual [grey levels]");
    v("sample_spacing_px", c.sample_spacing_px, 0.1, 10.0, "spacing of samples along the blur path [px]");
    v("max_samples", c.max_samples, 1, 256, "most samples along the blur path");
    v("unknown_exposure", c.unknown_exposure, 0.0, 1.0, "exposure assumed where it is unknown, at first [s]");
    v("estimate_exposure", c.estimate_exposure,
      "estimate it then; correct exposures that came with the images if they are clearly wrong");
    v("min_inlier_fraction", c.min_inlier_fraction, 0.0, 1.0, "inlier pixels below which a frame is lost");
    v("degraded_inlier_fraction", c.degraded_inlier_fraction, 0.0, 1.0, "inlier pixels below which it is degraded");
    v("degraded_pixel_error", c.degraded_pixel_error, 0.1, 100.0,
      "residual over gradient above which a frame is degraded [px]");
    v("max_pixel_error", c.max_pixel_error, 0.1, 100.0, "the same, above which it is lost [px]");
    v("degraded_expected_error", c.degraded_expected_error, 0.01, 100.0,
      "std. deviation of the points in the image by the covariance of the pose, above which it is degraded [px]");
    v("min_patches", c.min_patches, 5, 1000, "visible patches below which a frame is lost");
    v.section("motion_prior", c.motion_prior);
  }
};

/// Where the alignment begins.
struct TrackingGuess {
  TrackingGuess(const ExposureTrajectory& t) : trajectory(t) {}  // NOLINT(google-explicit-constructor)
  TrackingGuess(const MotionPrior& m, double exposure) : trajectory(m.predict(exposure)), motion(m) {}

  ExposureTrajectory trajectory;      // relative to the reference; exposure 0: aligned as a sharp image
  std::optional<MotionPrior> motion;  // also gives the priors and the alternative starts
  AffineBrightness brightness;        // of the frame
  bool is_close = false;              // to within a few pixels: no other starts, only the finer levels
};

/// Blur-aware direct image alignment of one frame to one reference (Eq. 7 of the paper), coarse to fine. Stateless.
class Tracker {
 public:
  explicit Tracker(const TrackerConfig& config) : config_(config) {}

  /// Status is kTracking, kDegraded or kLost, with the reason.
  TrackedFrame track(const Reference& reference, const FrameConstPtr& given, const TrackingGuess& guess) const;

 private:
  struct Job;
  struct LevelResult;
  enum class Freedom { kAll, kRotation };
  std::vector<AlignmentState> starts(const Job& job) const;
  static AlignmentState startAt(const Job& job, AlignmentState start, const SE3& pose);
  AlignmentState turned(const Job& job, int level, AlignmentState start) const;
  AlignmentState bestStart(const Job& job, int level) const;
  Vector6 bendFor(const Job& job, const AlignmentState& state) const;
  LevelResult align(const Job& job, int level, const AlignmentState& initial, int max_iterations,
                    double huber_threshold, Freedom freedom = Freedom::kAll) const;
  LevelResult preferExpectedDirection(const Job& job, const LevelResult& result) const;
  std::optional<AlignmentPrior> priorFor(const Job& job, const AlignmentState& state) const;
  Matrix12 covarianceOf(const Job& job, const LevelResult& result, double blur_px) const;
  void judge(const Reference& reference, double log_gain, TrackedFrame& tracked) const;

  TrackerConfig config_;
};

}  // namespace mba_vo
