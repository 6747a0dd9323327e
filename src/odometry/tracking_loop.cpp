#include "mba_vo/odometry/tracking_loop.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "mba_vo/odometry/frame_judge.h"
#include "mba_vo/odometry/image_check.h"
#include "mba_vo/odometry/keyframe_demand.h"
#include "mba_vo/odometry/orientation_tracking.h"
#include "mba_vo/odometry/recent_frames.h"
#include "mba_vo/odometry/tracking_results.h"
#include "mba_vo/odometry/waiting_frames.h"
#include "mba_vo/tracking/exposure_estimator.h"
#include "mba_vo/tracking/lost_clock.h"

namespace mba_vo {
namespace {

constexpr double kMapperTime = 1.0;       // [s] frames wait for so much longer than the initialiser keeps them
constexpr double kLongestRevision = 1.0;  // [s] of frames that are tracked once more while new ones come
constexpr double kUnknownVariance = 1e6;  // of a position that nothing has measured [m^2]
constexpr const char* kNoMap = "no map yet";

double secondsBetween(const TrackingState& last, const Frame& frame) {
  return 1e-9 * static_cast<double>(frame.mid_exposure_ns - last.lastNs());
}

}  // namespace

class TrackingLoop::Impl {
 public:
  explicit Impl(const OdometryConfig& config)
      : tracker_config_(config.tracker),
        tracker_(config.tracker),
        exposures_(config.tracker),
        orientation_(config.tracker),
        judge_(config.tracker),
        demand_(KeyframePolicy(config.keyframe)),
        restart_after_lost_(config.mapper.restart_after_lost),
        longest_wait_(config.mapper.initializer.buffer_seconds + kMapperTime) {}

  TrackedFrameConstPtr process(const FrameConstPtr& frame, bool has_time) {
    const std::string problem = image_check_.problemOf(frame);
    if (!problem.empty()) return blind(frame, problem);
    if (reference_ && lost_.seconds() >= restart_after_lost_) {  // as the mapper does
      reference_.reset();
      no_map_reason_ = "lost for too long, no map yet";
    }
    if (goesAhead() && !KeyframeDemand::isBad(worst_need_)) goOnFromNewest();
    if (reference_ && waiting_.empty()) {
      auto tracked = track({frame, true, false, false, {}});
      if (image_check_.repeated()) degrade(*tracked, "the image repeats the one before");
      return tracked;
    }
    if (auto tracked = trackAhead(frame)) return tracked;
    const auto result = untracked(frame, TrackingStatus::kInitializing,
                                  reference_ ? "earlier frames are still being tracked" : no_map_reason_);
    if (!reference_ && has_time) trackOrientation(*result);
    waiting_.add({frame, false, false, false, T_odom_camera_});
    waiting_.dropOlderThan(longest_wait_);
    return result;
  }

  bool take(const ReferenceConstPtr& reference, bool may_go_back) {
    if (!reference->withdrawn.empty()) return leave(*reference);
    if (isSharperImage(*reference)) {
      reference_ = reference;
      return true;
    }
    const bool found = reference_ && lost_.lost() && reference->hint;  // by the mapper, in this map
    if (!goesAhead()) rememberNewest();
    if (reference_ && reference_->id.map_id == reference->id.map_id) {
      const SE3 T_new_old = T_newReference_oldReference(*reference);
      state_.changeReference(T_new_old);
      if (newest_) newest_->changeReference(T_new_old);
      recent_.changeReference(T_new_old);
      exposures_.changeReference(T_new_old);
      T_odom_reference_ = T_odom_reference_ * T_new_old.inverse();
      if (found) state_ = TrackingState(*reference);
    } else if (reference->hint) {
      state_ = TrackingState(*reference);
      T_odom_reference_ = waiting_.T_odom_cameraAt(reference->hint->frame_sequence, T_odom_camera_) *
                          state_.T_reference_last().inverse();
      T_odom_first_.reset();
      newest_.reset();
      recent_.clear();
      judge_.reset();
      exposures_.forgetFrames();
    } else {
      return false;
    }
    reference_ = reference;
    lost_.find();
    demand_.meet();
    std::vector<RecentFrames::Entry> frames = recent_.takeAfter(found ? state_.lastNs() : reference->mid_exposure_ns);
    if (found && !frames.empty()) frames.front().before = state_;
    if (may_go_back) trackAgain(frames);
    return true;
  }

  TrackedFrameConstPtr trackWaiting(bool may_hold) {
    if (!reference_) return nullptr;
    waiting_.dropUntil(state_.lastNs());
    if (waiting_.empty()) newest_.reset();
    if (waiting_.empty() || (may_hold && demand_.holds(waiting_))) return nullptr;
    const auto tracked = track(waiting_.takeFirst());
    if (tracked->tracked() || !newest_) return tracked;
    goOnFromNewest();
    return nullptr;
  }

  std::size_t waitingFrames() const { return waiting_.size(); }
  bool goesAhead() const { return newest_ && waiting_.areRevisions(); }
  bool catchesUp() const { return !waiting_.empty() && !waiting_.areRevisions(); }

  void reset() {
    reference_.reset();
    waiting_.clear();
    newest_.reset();
    recent_.clear();
    judge_.reset();
    exposures_.reset();
    lost_.find();
    no_map_reason_ = kNoMap;
    image_check_.reset();
    demand_.meet();
    T_odom_first_.reset();
    T_odom_camera_ = SE3();
    T_odom_reference_ = SE3();
  }

  const SE3& T_odom_camera() const { return T_odom_camera_; }
  std::optional<SE3> predicted_T_odom_camera(std::int64_t mid_exposure_ns) const {
    if (!reference_ || !lost_.lost()) return std::nullopt;
    return T_odom_reference_ * state_.constantVelocityAt(mid_exposure_ns);
  }
  SE3 T_map_odom() const { return reference_ ? reference_->T_map_reference * T_odom_reference_.inverse() : SE3(); }
  ReferenceConstPtr reference() const { return reference_; }

 private:
  /// An image to which nothing can be aligned.
  TrackedFrameConstPtr blind(const FrameConstPtr& frame, const std::string& problem) {
    const auto result = untracked(frame, reference_ ? TrackingStatus::kLost : TrackingStatus::kInitializing, problem);
    result->blind = true;
    if (reference_) lost_.lose(frame->mid_exposure_ns, true);
    return result;
  }

  /// Of the keyframe in use. The demand for the next one remains, and what saw this one badly still does.
  bool isSharperImage(const Reference& reference) const {
    return reference_ && !reference.hint && reference_->id.map_id == reference.id.map_id &&
           reference_->id.keyframe_id == reference.id.keyframe_id && reference_->pyramid != reference.pyramid;
  }

  /// The mapper has given up the map: the next one is waited for.
  bool leave(const Reference& withdrawn) {
    if (!reference_ || reference_->id.map_id != withdrawn.id.map_id) return false;
    reference_.reset();
    newest_.reset();
    recent_.clear();
    lost_.find();
    no_map_reason_ = withdrawn.withdrawn;
    return true;
  }

  /// Without a map the odometry still turns with the camera.
  void trackOrientation(TrackedFrame& result) {
    if (!T_odom_first_) {
      orientation_.reset();
      T_odom_first_ = T_odom_camera_;
    }
    result.orientation_only = orientation_.track(result.frame);
    result.trajectory = orientation_.last();
    result.covariance.diagonal().head<3>().setConstant(kUnknownVariance);
    result.covariance.block<3, 3>(3, 3) = orientation_.covariance();
    T_odom_camera_ = *T_odom_first_ * result.trajectory.T_reference_mid;
  }

  /// Goes back to the first of the frames, which are seen better by the reference that has just come.
  void trackAgain(const std::vector<RecentFrames::Entry>& frames) {
    if (frames.empty()) return;
    state_ = frames.front().before;
    for (const RecentFrames::Entry& entry : frames) worst_need_ = std::max(worst_need_, entry.need);
    waiting_.addRevisions(frames);
  }

  void rememberNewest() {
    newest_.reset();
    if (!lost_.lost()) newest_ = state_;
    worst_need_ = 0.0;
  }

  /// While frames that have been seen badly are tracked once more, a new frame gets a first result from what is known
  /// without them, and then waits behind them.
  std::shared_ptr<TrackedFrame> trackAhead(const FrameConstPtr& given) {
    if (!reference_ || !goesAhead()) return nullptr;
    const FrameConstPtr frame = withExposure(given, exposures_.exposureFor(given->exposure));
    const TrackingGuess guess = newest_->guessFor(*frame, tracker_config_.unknown_exposure);
    auto tracked = std::make_shared<TrackedFrame>(tracker_.track(*reference_, frame, guess));
    judge_.judge(*tracked, false, secondsBetween(*newest_, *frame));
    if (!tracked->tracked()) {
      newest_.reset();
      return nullptr;
    }
    tracked->exposure_estimate = exposures_.estimate(given->exposure.has_value());
    tracked->provisional = true;
    newest_->update(*tracked);
    T_odom_camera_ = T_odom_reference_ * tracked->trajectory.T_reference_mid;
    waiting_.add({given, true, false, true, {}});
    if (waiting_.seconds() > kLongestRevision) goOnFromNewest();
    return tracked;
  }

  /// The first results of the frames that wait are good enough.
  void goOnFromNewest() {
    state_ = *newest_;
    newest_.reset();
    waiting_.clear();
    lost_.find();
  }

  std::shared_ptr<TrackedFrame> track(const WaitingFrame& next) {
    const FrameConstPtr frame = withExposure(next.frame, exposures_.exposureFor(next.frame->exposure));
    const TrackingGuess guess = state_.guessFor(*frame, tracker_config_.unknown_exposure);
    auto tracked = std::make_shared<TrackedFrame>(tracker_.track(*reference_, frame, guess));
    RecentFrames::Entry entry = {next.frame, next.in_time, next.mapped, KeyframeDemand::kLost, state_};
    tracked->exposure_estimate = exposures_.estimate(next.frame->exposure.has_value());
    exposures_.add(reference_, tracked, next.frame->exposure);
    judge_.judge(*tracked, lost_.lost(), secondsBetween(state_, *frame));
    if (!tracked->tracked()) {
      lost_.lose(frame->mid_exposure_ns, false);
    } else {
      lost_.find();
      state_.update(*tracked);
      T_odom_camera_ = T_odom_reference_ * tracked->trajectory.T_reference_mid;
      demand_.judge(*reference_, next.mapped, *tracked);
      entry.mapped = next.mapped || !tracked->provisional;
      entry.need = demand_.need();
    }
    recent_.add(entry, !tracked->tracked() || demand_.isWorthRevision());
    return tracked;
  }

  /// Through the poses that came with the new snapshot: map coordinates of different moments do not mix.
  SE3 T_newReference_oldReference(const Reference& next) const {
    const auto found = next.T_map_keyframe.find(reference_->id.keyframe_id);
    const SE3 T_map_old = found != next.T_map_keyframe.end() ? found->second : reference_->T_map_reference;
    return next.T_map_reference.inverse() * T_map_old;
  }

  TrackerConfig tracker_config_;
  Tracker tracker_;
  ExposureEstimator exposures_;
  OrientationTracking orientation_;
  FrameJudge judge_;
  KeyframeDemand demand_;
  double restart_after_lost_;  // [s]
  double longest_wait_;        // [s]
  ReferenceConstPtr reference_;
  WaitingFrames waiting_;
  RecentFrames recent_;                  // before those that wait
  TrackingState state_;                  // relative to reference_
  std::optional<TrackingState> newest_;  // by first results, while frames are tracked once more
  double worst_need_ = 0.0;              // of these frames, when they were tracked before
  ImageCheck image_check_;
  LostClock lost_;
  std::string no_map_reason_ = kNoMap;
  SE3 T_odom_camera_;
  SE3 T_odom_reference_;
  std::optional<SE3> T_odom_first_;  // of the first frame without a map
};

TrackingLoop::TrackingLoop(const OdometryConfig& config) : impl_(std::make_unique<Impl>(config)) {}
TrackingLoop::~TrackingLoop() = default;
TrackedFrameConstPtr TrackingLoop::process(const FrameConstPtr& frame, bool has_time) {
  return impl_->process(frame, has_time);
}
bool TrackingLoop::take(const ReferenceConstPtr& reference, bool may_go_back) {
  return impl_->take(reference, may_go_back);
}
TrackedFrameConstPtr TrackingLoop::trackWaiting(bool may_hold) { return impl_->trackWaiting(may_hold); }
std::size_t TrackingLoop::waitingFrames() const { return impl_->waitingFrames(); }
bool TrackingLoop::goesAhead() const { return impl_->goesAhead(); }
bool TrackingLoop::catchesUp() const { return impl_->catchesUp(); }
void TrackingLoop::reset() { impl_->reset(); }
const SE3& TrackingLoop::T_odom_camera() const { return impl_->T_odom_camera(); }
std::optional<SE3> TrackingLoop::predicted_T_odom_camera(std::int64_t mid_exposure_ns) const {
  return impl_->predicted_T_odom_camera(mid_exposure_ns);
}
SE3 TrackingLoop::T_map_odom() const { return impl_->T_map_odom(); }
ReferenceConstPtr TrackingLoop::reference() const { return impl_->reference(); }

}  // namespace mba_vo
