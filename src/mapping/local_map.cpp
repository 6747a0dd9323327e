#include "mba_vo/mapping/local_map.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "mba_vo/geometry/median.h"
#include "mba_vo/image/parallel_for.h"
#include "mba_vo/image/point_selector.h"
#include "mba_vo/mapping/point_activator.h"
#include "mba_vo/window/motion_alignment.h"
#include "stage_clock.h"

namespace mba_vo {
namespace {

constexpr int kHostsSearched = 5;             // the newest: what an older one has not found by then is out of sight
constexpr std::size_t kPointsPerSearch = 64;  // in one piece of parallel work
constexpr double kSameExposure = 0.03;        // of its logarithm: a smaller change is not worth reading images again

/// As it would enter a window; its id is left open.
WindowKeyframe windowKeyframe(const FrameConstPtr& frame, const SE3& T_map_camera, const BodyMotion& motion,
                              const AffineBrightness& brightness) {
  WindowKeyframe keyframe;
  keyframe.original = std::shared_ptr<const ImagePyramid>(frame, &frame->pyramid);
  keyframe.sharp = keyframe.original;
  keyframe.T_map_keyframe = T_map_camera;
  keyframe.motion = motion;
  // Where the exposure is unknown, the image is left as if it were sharp.
  keyframe.xi = motion.velocity * frame->exposure.value_or(0.0);
  keyframe.brightness = brightness;
  keyframe.correction = frame->correction;
  return keyframe;
}

}  // namespace

LocalMap::LocalMap(const MapperConfig& config, MapId id, const InitialMap& initial, const BodyMotion& reference_motion,
                   const Place& place, TrajectoryStore& store, CalibrationEstimator& calibration)
    : config_(config),
      id_(id),
      store_(store),
      calibration_(calibration),
      metric_(initial.metric),
      window_(config.window),
      next_keyframe_(place.keyframe),
      budget_(config.window.max_points) {
  window_.setCorrection(calibration_.correction());
  if (!config_.refine_calibration) window_.settleCorrection();
  const FrameConstPtr& frame = initial.reference;
  addKeyframe(frame, windowKeyframe(frame, place.T_map_keyframe, reference_motion, place.brightness));
  for (const ReferencePoint& point : initial.points) {
    const MeasuredDepth depth{static_cast<double>(point.inverse_depth), static_cast<double>(point.variance)};
    window_.addPoint(newestKeyframe(), point.pixel.cast<double>(), depth.inverse_depth,
                     metric_ || place.has_depths ? depth : MeasuredDepth());
  }
  selectImmaturePoints(keyframes_.at(newestKeyframe()));
  storePoses();
}

SE3 LocalMap::T_map_camera(const TrackedFrame& tracked) const {
  return store_.T_map_keyframe(id_, tracked.reference.keyframe_id) * tracked.trajectory.T_reference_mid;
}

std::optional<ExposureTrajectory> LocalMap::align(const TrackedFrame& tracked) const {
  if (!config_.window.reblur_targets) return std::nullopt;
  const std::optional<KeyframeMotion> found = window_.align(
      windowKeyframe(tracked.frame, T_map_camera(tracked), tracked.trajectory.motion(), tracked.brightness));
  if (!found) return std::nullopt;
  const SE3 T_map_reference = store_.T_map_keyframe(id_, tracked.reference.keyframe_id);
  const double exposure = *tracked.frame->exposure;  // known, or it would count as sharp
  return ExposureTrajectory{T_map_reference.inverse() * found->T_map_keyframe, found->xi / exposure, exposure};
}

void LocalMap::addKeyframe(const FrameConstPtr& frame, WindowKeyframe keyframe) {
  keyframe.id = next_keyframe_++;
  // It has the whole motion in it, until it is replaced by a sharp one.
  if (config_.commute_blur) keyframe.image_xi = keyframe.xi;
  window_.addKeyframe(keyframe);
  const auto untold = frame->exposureWasTold() ? std::nullopt : std::make_optional(frame->exposure.value_or(0.0));
  keyframes_[keyframe.id] = {frame, keyframe.original, untold, {}};
}

/// As is known now [s].
std::optional<double> LocalMap::exposureOf(const HostKeyframe& keyframe) {
  return keyframe.exposure.value_or(0.0) > 0.0 ? keyframe.exposure : keyframe.frame->exposure;
}

/// Of keyframes that were made when less was known, the first ones for sharp.
void LocalMap::reviseExposures(const ExposureHistory& exposures) {
  for (auto& [id, keyframe] : keyframes_) {
    if (!keyframe.exposure) continue;
    const double exposure = exposures.exposureAt(keyframe.frame->midExposureSeconds());
    if (std::abs(std::log(exposure / *keyframe.exposure)) < kSameExposure) continue;
    window_.setExposure(id, exposure, config_.commute_blur && keyframe.image.get() == &keyframe.frame->pyramid);
    keyframe.exposure = exposure;
  }
}

/// The image of a keyframe that was made with an earlier correction shows everything a little beside its place.
std::shared_ptr<const ImagePyramid> LocalMap::imageAsKnownNow(const HostKeyframe& keyframe) const {
  const CalibrationCorrection lacking =
      pinholePart(keyframe.frame->correction.lacks(calibration_.correction()), keyframe.image->level(0).camera);
  if (lacking.isZero()) return keyframe.image;
  const auto image = std::make_shared<ImagePyramid>(*keyframe.image);
  image->correctCamera(lacking);
  return image;
}

void LocalMap::searchDepths(const TrackedFrame& tracked) {
  const StageClock::time_point begin = StageClock::now();
  const SE3 T_map_frame = T_map_camera(tracked);
  const double inverse_depth = median(window_.inverseDepths());
  const FrameConstPtr frame = withCamera(tracked.frame, calibration_.correction());
  const auto hosts = std::min<std::ptrdiff_t>(kHostsSearched, std::distance(keyframes_.begin(), keyframes_.end()));
  for (auto keyframe = std::prev(keyframes_.end(), hosts); keyframe != keyframes_.end(); ++keyframe) {
    const KeyframeId id = keyframe->first;
    HostKeyframe& host = keyframe->second;
    ExposureTrajectory in_host = tracked.trajectory;
    in_host.T_reference_mid = window_.T_map_keyframe(id).inverse() * T_map_frame;
    const AffineBrightness host_brightness = window_.brightness(id);
    const double gain = std::exp(tracked.brightness.a - host_brightness.a);
    const double offset = tracked.brightness.b - gain * host_brightness.b;
    const std::shared_ptr<const ImagePyramid> host_image = imageAsKnownNow(host);
    const VignetteRatio vignette(host_image->level(0).camera, host.frame->correction.lacks(calibration_.correction()),
                                 frame->pyramid.level(0).camera, frame->correction.lacks(calibration_.correction()));
    const DepthSearcher searcher(*host_image, frame->pyramid, in_host, gain, offset, config_.depth_search,
                                 {window_.motion(id), window_.imageMotion(id), inverse_depth}, vignette);
    const std::size_t chunks = (host.immature.size() + kPointsPerSearch - 1) / kPointsPerSearch;
    parallelFor(chunks, [&, &immature = host.immature](std::size_t chunk) {
      const std::size_t end = std::min((chunk + 1) * kPointsPerSearch, immature.size());
      for (std::size_t i = chunk * kPointsPerSearch; i < end; ++i) searcher.search(immature[i]);
    });
  }
  depth_search_ms_ += millisecondsSince(begin);
}

bool LocalMap::explainsAsWell(KeyframeId keyframe, const std::shared_ptr<const ImagePyramid>& sharp) const {
  return window_.explainsAsWell(keyframe, sharp, pointsSeenBy(window_, window_.points(), keyframe));
}

void LocalMap::replaceImage(KeyframeId keyframe, const std::shared_ptr<const ImagePyramid>& sharp) {
  HostKeyframe& host = keyframes_.at(keyframe);
  host.image = sharp;
  for (ImmaturePoint& point : host.immature) point.energy_threshold = 0.0;  // to be computed from the new image
  window_.replaceImage(keyframe, sharp);
}

KeyframeReport LocalMap::insertKeyframe(const TrackedFrame& tracked, const BodyMotion& motion) {
  KeyframeReport report;
  const StageClock::time_point begin = StageClock::now();
  if (tracked.exposures) reviseExposures(*tracked.exposures);
  WindowKeyframe keyframe = windowKeyframe(tracked.frame, T_map_camera(tracked), motion, tracked.brightness);
  keyframe.blur_length_px = tracked.measures.blur_length_px;
  adoptRevisedMotion();
  addKeyframe(tracked.frame, std::move(keyframe));
  window_.addResidualsTo(newestKeyframe());
  const StageClock::time_point stage = StageClock::now();
  alignBlurred(tracked.measures.blur_length_px);
  report.wanted_points = budget_.points();
  report.activation_residuals = activatePoints();
  storePoses();
  refinement_ = {};
  report.activation_ms = millisecondsSince(stage);

  report.keyframe_id = newestKeyframe();
  report.frame_sequence = tracked.frame->sequence;
  report.mid_exposure_ns = tracked.frame->mid_exposure_ns;
  report.blur_length_px = tracked.measures.blur_length_px;
  report.total_ms = millisecondsSince(begin);
  return report;
}

/// Returns how many residuals that took.
int LocalMap::activatePoints() {
  const int wanted = budget_.points();
  activation_distance_px_ = adaptedDistance(activation_distance_px_, window_.pointCount(), wanted);
  PointActivator activator(window_, newestKeyframe(), activation_distance_px_);
  const auto newest = std::prev(keyframes_.end());
  for (auto host = keyframes_.begin(); host != newest; ++host) {
    activator.activateFound(host->first, host->second.immature);
  }
  if (!activator.isStarving(wanted)) return activator.residuals();
  // What has just come into view is in the last ones.
  for (auto host = newest; host != keyframes_.begin() && !activator.isFull(wanted);) {
    --host;
    activator.activateGuessed(host->first, host->second.immature);
  }
  return activator.residuals();
}

/// The newest keyframe, with the points that there are now.
void LocalMap::alignBlurred(double blur_length_px) {
  if (config_.window.reblur_targets && blur_length_px >= kLongBlur) window_.alignNewest();
}

void LocalMap::selectImmaturePoints(HostKeyframe& host) const {
  PointSelectorConfig options;
  options.faint_texture = true;
  for (const Eigen::Vector2i& pixel : selectPoints(*host.image, config_.new_points_per_keyframe, options)) {
    ImmaturePoint point;
    point.pixel = pixel;
    if (metric_ && !host.frame->depth.empty()) {
      point.measured = measureDepth(host.frame->depth, pixel, config_.depth_sensor);
      if (point.measured.known()) point.inverse_depth_min = point.inverse_depth_max = point.measured.inverse_depth;
    }
    host.immature.push_back(point);
  }
}

void LocalMap::storePoses() {
  for (const KeyframeId id : window_.keyframes()) store_.setKeyframePose(id_, id, window_.T_map_keyframe(id));
}

std::shared_ptr<Reference> LocalMap::makeReference(KeyframeId keyframe, const std::string& doubt) const {
  auto reference = std::make_shared<Reference>();
  reference->doubt = doubt;
  reference->id = {id_, keyframe, 0};
  reference->metric = metric_;
  reference->mid_exposure_ns = keyframes_.at(keyframe).frame->mid_exposure_ns;
  reference->exposure = exposureOf(keyframes_.at(keyframe));
  reference->exposure_log_sigma = keyframes_.at(keyframe).frame->exposure_log_sigma;
  reference->T_map_reference = window_.T_map_keyframe(keyframe);
  reference->pyramid = imageAsKnownNow(keyframes_.at(keyframe));
  reference->image_xi = window_.imageMotion(keyframe);
  reference->brightness = window_.brightness(keyframe);
  reference->motion = window_.motion(keyframe);
  reference->image_correction = keyframes_.at(keyframe).frame->correction;
  reference->correction = calibration_.correction();
  reference->settled_correction = calibration_.settled();
  reference->points = pointsSeenBy(window_, window_.points(), keyframe);
  for (const KeyframeId id : window_.keyframes()) reference->T_map_keyframe[id] = window_.T_map_keyframe(id);
  return reference;
}

StampedPose LocalMap::stampedPose(KeyframeId keyframe) const {
  return {frame(keyframe)->mid_exposure_ns, window_.T_map_keyframe(keyframe), window_.motion(keyframe).velocity};
}

MapPoint LocalMap::displayPoint(const WindowPoint& point) const {
  const HostKeyframe& host = keyframes_.at(point.host);
  const ImageLevel& level = host.image->level(0);
  const Eigen::Vector3d in_host = level.camera.unproject(point.pixel) / point.inverse_depth;
  const auto x = static_cast<int>(std::lround(point.pixel.x()));
  const auto y = static_cast<int>(std::lround(point.pixel.y()));
  return {window_.T_map_keyframe(point.host) * in_host, level.intensity(y, x), point.host, host.frame->mid_exposure_ns,
          id_};
}

void LocalMap::keepForDisplay(KeyframeId keyframe) {
  const auto limit = static_cast<std::size_t>(config_.max_display_points);
  for (const WindowPoint& point : window_.points()) {
    if (point.host == keyframe) old_points_.push_back(displayPoint(point));
  }
  if (old_points_.size() > limit) {
    old_points_.erase(old_points_.begin(), old_points_.end() - static_cast<std::ptrdiff_t>(limit));
  }
}

std::vector<MapPoint> LocalMap::points() const {
  std::vector<MapPoint> all = old_points_;
  for (const WindowPoint& point : window_.points()) all.push_back(displayPoint(point));
  return all;
}

}  // namespace mba_vo
