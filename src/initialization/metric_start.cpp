#include "mba_vo/initialization/metric_start.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "mba_vo/image/point_selector.h"
#include "mba_vo/initialization/initializer_bundle.h"

namespace mba_vo {
namespace {

constexpr double kMostBlur = 1.0 / 30.0;  // of the image's width, that is worth no wait
constexpr int kPoints = 1000;             // of the first keyframe, those without depth included
constexpr std::size_t kMinPoints = 100;   // with depth
constexpr int kMinTracks = 30;            // of a neighbouring frame, to find its pose
constexpr double kSigma = 0.5;            // of a track [px]
constexpr double kTolerance = 2.0;        // of a track [px]
constexpr double kMinAgreeing = 0.6;      // share of the tracks that must agree with the depths

Bundle makeBundle(const InitializerImage& image, const std::vector<Eigen::Vector2d>& corners,
                  const DepthSensorConfig& sensor) {
  Bundle bundle;
  bundle.camera = image.camera;
  for (const Eigen::Vector2d& corner : corners) {
    const Eigen::Vector2d pixel = image.toLevel0(corner);
    const Eigen::Vector2i nearest(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
    bundle.rays.push_back(image.camera.unproject(corner));
    bundle.inverse_depth.push_back(measureDepth(image.frame->depth, nearest, sensor).inverse_depth);
  }
  return bundle;
}

double shareExplained(const Bundle& bundle, const BundleView& view) {
  const std::vector<double> errors = reprojectionErrors(bundle, view);
  const auto inside = std::count_if(errors.begin(), errors.end(), [](double e) { return e < kTolerance; });
  return static_cast<double>(inside) / static_cast<double>(std::max<std::size_t>(errors.size(), 1));
}

}  // namespace

void MetricStart::reset() {
  reason_.clear();
  rejected_.clear();
}

bool MetricStart::isCandidate(const BufferedImage& entry) const {
  const Frame& frame = *entry.image->frame;
  return !frame.depth.empty() && rejected_.count(frame.mid_exposure_ns) == 0;
}

std::unique_ptr<InitialMap> MetricStart::attempt(const InitializerBuffer& buffer) {
  const auto& images = buffer.images();
  std::size_t first = images.size();
  std::size_t best = images.size();
  for (std::size_t i = 0; i + 1 < images.size(); ++i) {
    if (!isCandidate(images[i])) continue;
    first = std::min(first, i);
    if (best == images.size() || images[i].log_sharpness > images[best].log_sharpness) best = i;
  }
  if (best == images.size()) return nullptr;
  const auto seconds = [&](std::size_t i) { return images[i].image->frame->midExposureSeconds(); };
  const double most_blur = kMostBlur * images[best].image->frame->pyramid.level(0).camera.width;
  if (buffer.blurLength(best) > most_blur && seconds(images.size() - 1) - seconds(first) < max_wait_) {
    reason_ = "waiting for a sharper frame with depths";
    return nullptr;
  }
  auto map = begin(buffer, best);
  if (!map) rejected_.insert(images[best].image->frame->mid_exposure_ns);
  return map;
}

std::unique_ptr<InitialMap> MetricStart::begin(const InitializerBuffer& buffer, std::size_t index) {
  auto map = std::make_unique<InitialMap>();
  const InitializerImageConstPtr& reference = buffer.images()[index].image;
  map->reference = reference->frame;
  map->metric = true;
  const ReferenceTracker tracker(reference, max_corners_);
  if (!addPoints(*map)) return nullptr;
  if (index > 0 && !addPose(buffer, tracker, index, false, *map)) return nullptr;
  if (!addPose(buffer, tracker, index, true, *map)) return nullptr;
  reason_.clear();
  return map;
}

bool MetricStart::addPoints(InitialMap& map) {
  for (const Eigen::Vector2i& pixel : selectPoints(map.reference->pyramid, kPoints, {})) {
    const MeasuredDepth measured = measureDepth(map.reference->depth, pixel, sensor_);
    if (!measured.known()) continue;
    map.points.push_back(
        {pixel.cast<float>(), static_cast<float>(measured.inverse_depth), static_cast<float>(measured.variance)});
  }
  if (map.points.size() >= kMinPoints) return true;
  reason_ = "depth image tells too little (" + std::to_string(map.points.size()) + " points, " +
            std::to_string(kMinPoints) + " needed)";
  return false;
}

/// Pose of the frame after (or before) the reference, by its tracks; false if they contradict the depths.
bool MetricStart::addPose(const InitializerBuffer& buffer, const ReferenceTracker& tracker, std::size_t index,
                          bool next, InitialMap& map) {
  const InitializerImage& reference = *buffer.images()[index].image;
  const BufferedImage& neighbour = buffer.images()[next ? index + 1 : index - 1];
  const ImageMotion& motion = buffer.images()[next ? index + 1 : index].motion;
  const Eigen::Matrix3d H = next ? motion.H_next_previous : Eigen::Matrix3d(motion.H_next_previous.inverse());
  // Two frames in a row are blurred much alike.
  const FrameTracks tracks = tracker.track(*neighbour.image, tracker.identity(), H, Eigen::Vector3d::Zero());
  const Bundle bundle = makeBundle(reference, tracker.corners(), sensor_);
  BundleView view;
  view.sigma = kSigma;
  view.pixel = tracks.pixel;
  view.observed = tracks.tracked;
  for (std::size_t p = 0; p < view.observed.size(); ++p) {
    if (!(bundle.inverse_depth[p] > 0.0)) view.observed[p] = 0;
  }
  Vector6 turn = Vector6::Zero();
  turn.tail<3>() = next ? motion.rotation : Eigen::Vector3d(-motion.rotation);
  view.T_view_reference = SE3::exp(turn);
  if (std::count(view.observed.begin(), view.observed.end(), 1) >= kMinTracks) {
    optimizePose(bundle, view, BundleOptions());
    const double explained = shareExplained(bundle, view);
    if (explained < kMinAgreeing) {
      reason_ = "depth image contradicts the images (" + std::to_string(static_cast<int>(1e2 * explained)) +
                " % of the tracks agree)";
      return false;
    }
  } else if (!motion.measured) {
    return true;  // nothing is known
  }
  map.poses.push_back({neighbour.image->frame, view.T_view_reference.inverse()});
  return true;
}

}  // namespace mba_vo
