#include "mba_vo/relocalization/relocalizer.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

constexpr double kMinCorrelation = 0.4;     // of small images, worth a trial
constexpr std::size_t kMostCandidates = 9;  // before the first one is tried again
constexpr int kAgreeingFrames = 3;          // the one that proposed the pose among them
constexpr double kLeastError = 0.5;         // [px] that is always good enough
constexpr double kUsualErrors = 1.5;        // so much more than usual is too
constexpr double kFastestTurn = 6.0;        // [rad/s] of a camera in a hand
constexpr double kFastestMotion = 3.0;      // [median depths/s]
constexpr int kMinPatches = 50;

TrackerConfig strict(TrackerConfig config) {
  config.min_patches = std::max(config.min_patches, kMinPatches);
  return config;
}

}  // namespace

Relocalizer::Relocalizer(const RelocalizerConfig& config, const TrackerConfig& tracker)
    : config_(config),
      unknown_exposure_(tracker.unknown_exposure),
      tracker_(strict(tracker)),
      archive_(config.max_keyframes) {}

void Relocalizer::restart() {
  suspicion_.reset();
  first_candidate_ = 0;
}

std::vector<PlaceCandidate> Relocalizer::candidates(const ImagePyramid& image) const {
  std::vector<PlaceCandidate> alike =
      archive_.places().search(PlaceDescriptor(image), kMostCandidates, [](KeyframeId) { return true; });
  while (!alike.empty() && alike.back().correlation < kMinCorrelation) alike.pop_back();
  return alike;
}

bool Relocalizer::isGood(const TrackedFrame& tracked, double usual_error) const {
  return tracked.status == TrackingStatus::kTracking && tracked.inlier_fraction >= config_.min_inlier_fraction &&
         tracked.measures.visible_fraction >= config_.min_visible_fraction &&
         tracked.pixel_error <= std::max(kLeastError, kUsualErrors * usual_error);
}

ExposureTrajectory Relocalizer::start(const PlaceCandidate& candidate, const Frame& frame) const {
  const PinholeCamera& camera = archive_.keyframes().at(candidate.keyframe).camera;
  // What the frame sees in its middle is in the keyframe at the middle + shift: the camera has turned there.
  Vector6 turn = Vector6::Zero();
  turn(3) = -std::atan2(candidate.shift_px.y(), camera.fy);
  turn(4) = std::atan2(candidate.shift_px.x(), camera.fx);
  return {SE3::exp(turn), Vector6::Zero(), frame.exposure.value_or(unknown_exposure_)};
}

std::optional<Relocalizer::Suspicion> Relocalizer::align(const PlaceCandidate& candidate, const FrameConstPtr& frame,
                                                         double usual_error) const {
  const ArchivedKeyframe& keyframe = archive_.keyframes().at(candidate.keyframe);
  Suspicion suspicion;
  suspicion.keyframe = candidate.keyframe;
  suspicion.keyframe_frame = keyframe.restoreFrame();
  suspicion.reference = keyframe.restoreReference(suspicion.keyframe_frame);
  TrackingGuess guess(start(candidate, *frame));
  guess.brightness = suspicion.reference->brightness;
  const TrackedFrame tracked = tracker_.track(*suspicion.reference, frame, guess);
  if (!isGood(tracked, usual_error)) return std::nullopt;
  suspicion.trajectory = tracked.trajectory;
  suspicion.mid_exposure_ns = frame->mid_exposure_ns;
  return suspicion;
}

bool Relocalizer::confirm(const FrameConstPtr& frame, double usual_error) {
  const double dt = 1e-9 * static_cast<double>(frame->mid_exposure_ns - suspicion_->mid_exposure_ns);
  if (dt <= 0.0) return false;
  TrackingGuess guess(suspicion_->trajectory);
  guess.trajectory.exposure = frame->exposure.value_or(unknown_exposure_);
  guess.brightness = suspicion_->reference->brightness;
  if (suspicion_->agreeing > 1) guess.trajectory.T_reference_mid = suspicion_->trajectory.at(dt);
  const TrackedFrame tracked = tracker_.track(*suspicion_->reference, frame, guess);
  if (!isGood(tracked, usual_error)) return false;
  const SE3 moved = suspicion_->trajectory.T_reference_mid.inverse() * tracked.trajectory.T_reference_mid;
  const Vector6 velocity = moved.log() / dt;
  const double median_depth = 1.0;  // in about the units of the map
  if (velocity.tail<3>().norm() > kFastestTurn || velocity.head<3>().norm() > kFastestMotion * median_depth)
    return false;
  suspicion_->trajectory = tracked.trajectory;
  // From pose to pose: blur alone does not tell forwards from backwards.
  suspicion_->trajectory.velocity = velocity;
  suspicion_->mid_exposure_ns = frame->mid_exposure_ns;
  ++suspicion_->agreeing;
  return true;
}

std::optional<Relocalizer::Found> Relocalizer::find(const FrameConstPtr& frame, double usual_error) {
  if (suspicion_ && confirm(frame, usual_error)) {
    if (suspicion_->agreeing < kAgreeingFrames) return std::nullopt;
    const Suspicion found = *suspicion_;
    restart();
    return Found{found.keyframe, found.keyframe_frame, {frame->sequence, frame->mid_exposure_ns, found.trajectory}};
  }
  suspicion_.reset();
  const std::vector<PlaceCandidate> ranked = candidates(frame->pyramid);
  if (first_candidate_ >= ranked.size()) first_candidate_ = 0;
  const std::size_t end =
      std::min(ranked.size(), first_candidate_ + static_cast<std::size_t>(config_.trials_per_frame));
  for (std::size_t i = first_candidate_; i < end && !suspicion_; ++i) {
    suspicion_ = align(ranked[i], frame, usual_error);
  }
  first_candidate_ = suspicion_ ? 0 : end;
  return std::nullopt;
}

}  // namespace mba_vo
