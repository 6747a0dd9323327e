#include "mba_vo/initialization/orientation_tracking.h"

#include <algorithm>
#include <optional>

#include "mba_vo/image/point_selector.h"
#include "mba_vo/initialization/initializer_image.h"
#include "mba_vo/tracking/frame_measures.h"

namespace mba_vo {
namespace {

constexpr float kFar = 1e-6F;           // inverse depth of everything
constexpr int kReferencePoints = 1000;  // of a reference
// Aligned per frame. Time goes with their number (on desk 132, 80, 46 and 31 ms for 1000, 300, 150 and 80, on a busy
// machine); on one core the initialiser needs that time.
constexpr int kPatches = 120;
constexpr double kOrigin = 1e-10;        // [rad^2] of the first: exact, but filters invert covariances
constexpr double kLargestFlow = 0.15;    // of the image's width, after which another reference is taken
constexpr double kLeastVisible = 0.7;    // the same, share of the points
constexpr double kLeastInliers = 0.8;    // the same: parallax has made it differ
constexpr double kSharpBlur = 2.0;       // [px]; a blurred frame becomes the reference only when it has to
constexpr double kMostReluctance = 1.5;  // how much later than a sharp one

TrackerConfig withFewPatches(TrackerConfig config) {
  config.max_points = std::min(config.max_points, kPatches);
  return config;
}

}  // namespace

OrientationTracking::OrientationTracking(const TrackerConfig& config)
    : tracker_(withFewPatches(config)), config_(config) {}

void OrientationTracking::reset() {
  reference_.reset();
  last_frame_.reset();
  T_first_reference_ = SE3();
  motion_ = MotionState();
  turns_ = {};
  brightness_ = AffineBrightness();
  covariance_ = kOrigin * Eigen::Matrix3d::Identity();
}

void OrientationTracking::begin(const FrameConstPtr& frame, const Eigen::Vector3d& angular_velocity) {
  reset();
  last_frame_ = frame;
  ExposureTrajectory motion;
  motion.velocity.tail<3>() = angular_velocity;
  motion_ = MotionState(motion, frame->mid_exposure_ns);
  turns_.add(frame->mid_exposure_ns, SE3(), std::nullopt);
  changeReference(frame, {});
}

ExposureTrajectory OrientationTracking::last() const {
  ExposureTrajectory last = motion_.last();
  last.T_reference_mid = T_first_reference_ * last.T_reference_mid;
  return last;
}

/// What the blur says of a frame's motion goes by that of the reference, which came from another's: poses put it right.
void OrientationTracking::add(TrackedFrame& tracked) {
  ExposureTrajectory& turn = tracked.trajectory;
  turns_.add(tracked.frame->mid_exposure_ns, T_first_reference_ * turn.T_reference_mid, observedMotion(tracked));
  turn.velocity = turns_.motionOfLast().velocity;
  motion_.update(tracked);
}

void OrientationTracking::changeReference(const FrameConstPtr& frame, const AffineBrightness& brightness) {
  const SE3 T_old_new = motion_.last().T_reference_mid;
  T_first_reference_ = T_first_reference_ * T_old_new;
  motion_.changeReference(T_old_new.inverse());
  auto reference = std::make_shared<Reference>();
  reference->at_infinity = true;
  reference->mid_exposure_ns = frame->mid_exposure_ns;
  reference->pyramid = std::shared_ptr<const ImagePyramid>(frame, &frame->pyramid);
  reference->motion.velocity = motion_.last().velocity;
  reference->image_xi = motion_.last().velocity * frame->exposure.value_or(0.0);
  reference->brightness = brightness;
  reference->image_correction = reference->correction = frame->correction;
  for (const Eigen::Vector2i& pixel : selectPoints(*reference->pyramid, kReferencePoints, {})) {
    reference->points.push_back({pixel.cast<float>(), kFar, 0.0F});
  }
  reference_ = reference;
}

std::optional<MotionPrior> OrientationTracking::priorByFeatures(const FrameConstPtr& frame) const {
  MotionPrior prior = motion_.priorAt(frame->mid_exposure_ns);
  const Eigen::Vector3d expected = -prior.dt * prior.previous.velocity.tail<3>();
  const ImageMotion motion = measureMotion(*makeInitializerImage(last_frame_), *makeInitializerImage(frame), expected);
  if (!motion.measured) return std::nullopt;
  prior.previous.velocity.tail<3>() = -motion.rotation / prior.dt;
  prior.acceleration.setZero();
  return prior;
}

bool OrientationTracking::track(const FrameConstPtr& frame) {
  if (!reference_ || frame->mid_exposure_ns <= motion_.lastNs()) {
    begin(frame, Eigen::Vector3d::Zero());
    return true;
  }
  const double exposure = frame->exposure.value_or(config_.unknown_exposure);
  TrackingGuess guess(motion_.priorAt(frame->mid_exposure_ns), exposure);
  guess.brightness = brightness_;
  TrackedFrame tracked = tracker_.track(*reference_, frame, guess);
  if (const auto prior = tracked.tracked() ? std::nullopt : priorByFeatures(frame)) {
    guess = TrackingGuess(*prior, exposure);
    guess.brightness = brightness_;
    tracked = tracker_.track(*reference_, frame, guess);
  }
  last_frame_ = frame;
  if (!tracked.tracked()) {
    // It may have stopped: a turn that nothing measures goes on no further.
    guess.trajectory.velocity.setZero();
    motion_ = MotionState(guess.trajectory, frame->mid_exposure_ns);
    turns_ = {};
    changeReference(frame, brightness_);
    return false;
  }
  add(tracked);
  brightness_ = tracked.brightness;
  covariance_ = tracked.covariance.block<3, 3>(3, 3);
  const FrameMeasures& seen = tracked.measures;
  const double reluctance = std::clamp(seen.blur_length_px / kSharpBlur, 1.0, kMostReluctance);
  const bool leaving = seen.flow_px > reluctance * kLargestFlow * frame->pyramid.level(0).camera.width ||
                       seen.visible_fraction < kLeastVisible / reluctance;
  if (leaving || tracked.inlier_fraction < kLeastInliers / reluctance) changeReference(frame, brightness_);
  return true;
}

}  // namespace mba_vo
