#include "mba_vo/initialization/initializer.h"

#include <cmath>
#include <cstdio>
#include <utility>

#include "mba_vo/blur/row_motion.h"
#include "mba_vo/initialization/initializer_buffer.h"
#include "mba_vo/initialization/initializer_structure.h"
#include "mba_vo/initialization/metric_start.h"

namespace mba_vo {
namespace {

constexpr int kImagesPerFrame = 3;    // tracked per added frame while catching up
constexpr double kLongestGap = 0.5;   // [s] between frames that are used together
constexpr double kRowTimeSpan = 0.3;  // [s] of images before a row time is believed
// Of an attempt, for which there is time between two images at 30 Hz: 16 ms and 6.7 ms a thousand (Machine).
constexpr double kResidualsPerImage = 2500.0;
// [px] for which a sharper frame is waited for (docs/decisions/2026-11-29-first-attempt.md) ...
constexpr double kMaxReferenceBlur = 16.0;
constexpr double kMaxReferenceWait = 1.0;  // ... this long [s]
constexpr int kMostDepthDoubts = 2;        // from which on depth images are not used

bool sameCamera(const PinholeCamera& a, const PinholeCamera& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy;
}

/// Tracks of the buffer as a problem of structure and motion; `view_of` receives the buffer's index of every view.
StructureProblem makeProblem(const InitializerBuffer& buffer, std::vector<std::size_t>& view_of) {
  StructureProblem problem;
  problem.camera = buffer.images()[buffer.reference()].image->camera;
  problem.reference_pixels = buffer.tracker().corners();
  const double reference_time = buffer.images()[buffer.reference()].image->frame->midExposureSeconds();
  for (std::size_t i = 0; i < buffer.images().size(); ++i) {
    const BufferedImage& entry = buffer.images()[i];
    if (i == buffer.reference() || !entry.tracks) continue;
    const double time = entry.image->frame->midExposureSeconds() - reference_time;
    problem.views.push_back({entry.tracks->pixel, entry.tracks->tracked, entry.log_sharpness, time});
    view_of.push_back(i);
  }
  return problem;
}

/// Velocity of the reference by the poses next to it [m/s, rad/s], in its axes.
Vector6 velocityAmid(const std::vector<InitialMap::Pose>& poses, const Frame& reference) {
  Vector6 before = Vector6::Zero(), after = Vector6::Zero();
  double begin = 0.0, end = 0.0;  // [s]
  for (const InitialMap::Pose& pose : poses) {
    const double time = pose.frame->midExposureSeconds() - reference.midExposureSeconds();
    if (time < 0.0 || end == 0.0) {
      (time < 0.0 ? before : after) = pose.T_reference_frame.log();
      (time < 0.0 ? begin : end) = time;
    }
  }
  return end > begin ? Vector6((after - before) / (end - begin)) : Vector6::Zero();
}

/// What is at `inverse_depth` at mid-exposure, when the row of the pixel is exposed. `camera`: with its row time.
double inverseDepthAtRow(const PinholeCamera& camera, const Vector6& velocity, const Eigen::Vector2d& pixel,
                         double inverse_depth) {
  const RigidMotion T_mid_row = shortMotion(velocity, camera.rowDelay(pixel.y()));
  const double z_mid = (T_mid_row.R * camera.unproject(pixel)).z();  // of a point at the depth 1 in the row's axes
  return z_mid * inverse_depth / (1.0 - inverse_depth * T_mid_row.p.z());
}

std::unique_ptr<InitialMap> makeMap(const InitializerBuffer& buffer, const std::vector<std::size_t>& view_of,
                                    const StructureEstimate& estimate) {
  auto map = std::make_unique<InitialMap>();
  const InitializerImage& reference = *buffer.images()[buffer.reference()].image;
  map->reference = reference.frame;
  map->row_time = estimate.row_time / static_cast<double>(1 << reference.level);
  for (std::size_t v = 0; v < view_of.size(); ++v) {
    if (!estimate.T_view_reference[v]) continue;
    map->poses.push_back({buffer.images()[view_of[v]].image->frame, estimate.T_view_reference[v]->inverse()});
  }
  PinholeCamera camera = reference.camera;
  camera.row_time += estimate.row_time;
  const Vector6 velocity = velocityAmid(map->poses, *reference.frame);
  const std::vector<Eigen::Vector2d>& corners = buffer.tracker().corners();
  for (std::size_t p = 0; p < corners.size(); ++p) {
    if (!std::isfinite(estimate.variance[p])) continue;
    const double inverse_depth = inverseDepthAtRow(camera, velocity, corners[p], estimate.inverse_depth[p]);
    map->points.push_back({reference.toLevel0(corners[p]).cast<float>(), static_cast<float>(inverse_depth),
                           static_cast<float>(estimate.variance[p])});
  }
  return map;
}

}  // namespace

class Initializer::Impl {
 public:
  Impl(const InitializerConfig& config, const DepthSensorConfig& sensor, bool find_row_time)
      : buffer_(config.buffer_seconds, config.max_points), metric_(config.depth_wait, config.max_points, sensor) {
    structure_.min_parallax = config.min_parallax;
    structure_.find_row_time = find_row_time;
  }

  std::unique_ptr<InitialMap> add(const FrameConstPtr& frame) {
    if (!continues(frame)) reset();
    buffer_.add(frame);
    residuals_ = 0;
    if (depth_doubts_ < kMostDepthDoubts) {
      if (auto map = metric_.attempt(buffer_)) return map;
    }
    buffer_.updateReference();
    buffer_.updateTracks(kImagesPerFrame);
    ++since_attempt_;
    return readyForAttempt() ? attempt() : nullptr;
  }

  std::vector<FrameConstPtr> bufferedFrames() const {
    std::vector<FrameConstPtr> frames;
    for (const BufferedImage& entry : buffer_.images()) frames.push_back(entry.image->frame);
    return frames;
  }

  const std::string& reason() const { return metric_.reason().empty() ? reason_ : metric_.reason(); }

  int residuals() const { return residuals_; }

  void doubtDepths(bool surely) {
    depth_doubts_ += surely ? kMostDepthDoubts : 1;
    metric_.reset();
  }
  void trustDepths() { depth_doubts_ = 0; }

  void reset() {
    buffer_.clear();
    metric_.reset();
    rolling_ = false;
    attempted_residuals_ = 0;
    since_attempt_ = 0;
    reason_ = "collecting frames";
  }

 private:
  bool continues(const FrameConstPtr& frame) const {
    if (buffer_.images().empty() || !frame || frame->pyramid.levels() < 1)
      return true;  // add() reports a missing image
    const Frame& last = *buffer_.images().back().image->frame;
    const double gap = frame->midExposureSeconds() - last.midExposureSeconds();
    return gap > 0.0 && gap < kLongestGap && sameCamera(frame->pyramid.level(0).camera, last.pyramid.level(0).camera);
  }

  bool readyForAttempt() {
    if (!buffer_.hasReference()) {
      reason_ = "collecting frames";
      return false;
    }
    if (rolling_ && buffer_.span() < kRowTimeSpan) return false;
    if (static_cast<int>(buffer_.tracker().corners().size()) < structure_.min_points) {
      reason_ = "too little texture (" + std::to_string(buffer_.tracker().corners().size()) + " corners, " +
                std::to_string(structure_.min_points) + " needed)";
      return false;
    }
    if (buffer_.blurLength(buffer_.reference()) > kMaxReferenceBlur && buffer_.span() < kMaxReferenceWait) {
      reason_ = "waiting for a sharper frame";
      return false;
    }
    return since_attempt_ * kResidualsPerImage >= attempted_residuals_;
  }

  std::unique_ptr<InitialMap> attempt() {
    since_attempt_ = 0;
    std::vector<std::size_t> view_of;
    const StructureProblem problem = makeProblem(buffer_, view_of);
    const StructureEstimate estimate = estimateStructure(problem, structure_);
    reason_ = estimate.reason;
    residuals_ = attempted_residuals_ = estimate.residuals;
    rolling_ = estimate.row_time != 0.0;
    if (reason_.empty() && rolling_ && buffer_.span() < kRowTimeSpan) {
      reason_ = "a rolling shutter, of which more is to be seen";
    }
    return reason_.empty() ? makeMap(buffer_, view_of, estimate) : nullptr;
  }

  StructureConfig structure_;
  InitializerBuffer buffer_;
  MetricStart metric_;
  int depth_doubts_ = 0;
  std::string reason_ = "collecting frames";
  bool rolling_ = false;         // the shutter, so it seems
  int attempted_residuals_ = 0;  // in the last attempt
  int since_attempt_ = 0;        // images
  int residuals_ = 0;
};

Initializer::Initializer(const InitializerConfig& config, const DepthSensorConfig& sensor, bool find_row_time)
    : impl_(std::make_unique<Impl>(config, sensor, find_row_time)) {}
Initializer::~Initializer() = default;

std::unique_ptr<InitialMap> Initializer::add(const FrameConstPtr& frame) { return impl_->add(frame); }
std::vector<FrameConstPtr> Initializer::bufferedFrames() const { return impl_->bufferedFrames(); }
const std::string& Initializer::reason() const { return impl_->reason(); }
int Initializer::residuals() const { return impl_->residuals(); }
void Initializer::reset() { impl_->reset(); }
void Initializer::doubtDepths(bool surely) { impl_->doubtDepths(surely); }
void Initializer::trustDepths() { impl_->trustDepths(); }

}  // namespace mba_vo
