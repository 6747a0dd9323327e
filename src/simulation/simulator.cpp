#include "mba_vo/simulation/simulator.h"

#include <cmath>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

#include "mba_vo/simulation/frame_cache.h"
#include "mba_vo/simulation/hand_held_motion.h"
#include "mba_vo/simulation/motion_piece.h"

namespace mba_vo {
namespace {

/// Compresses the image and shows what is left of it.
void compress(int quality, SimulatedFrame& frame) {
  cv::imencode(".jpg", frame.blurred, frame.jpeg, {cv::IMWRITE_JPEG_QUALITY, quality});
  frame.blurred = cv::imdecode(frame.jpeg, cv::IMREAD_UNCHANGED);
}

}  // namespace

Simulator::Stage Simulator::makeStage(const SimulationConfig& config, std::shared_ptr<const Scene> scene) {
  config.validate();
  if (config.motion.empty()) {
    const HandHeldMotion hand({config.trajectory_seed, config.duration, config.shake, config.path_length}, FreeSpace{});
    if (!scene) scene = std::make_shared<const Scene>(makeRoom(config.scene_seed));
    return {{[hand](double t) { return hand.pose(t); }, config.duration}, std::move(scene)};
  }
  const auto piece = std::make_shared<const MotionPiece>(config);
  if (!scene) scene = std::make_shared<const Scene>(makeRoomAround(piece->path(), config.scene_seed));
  return {{[piece](double t) { return piece->pose(t); }, piece->span()}, std::move(scene)};
}

Simulator::Simulator(const SimulationConfig& config) : Simulator(config, makeStage(config, nullptr)) {}

Simulator::Simulator(const SimulationConfig& config, std::shared_ptr<const Scene> scene)
    : Simulator(config, makeStage(config, std::move(scene))) {}

Simulator::Simulator(const SimulationConfig& config, Stage stage)
    : config_(config),
      motion_(std::move(stage.motion)),
      exposures_(config),
      renderer_(std::move(stage.scene), config.calibration(), {config.max_step, config.row_time}) {}

int Simulator::frames() const { return static_cast<int>(std::floor(motion_.span * config_.rate + 1e-9)) + 1; }

std::int64_t Simulator::stampNs(int index) const {
  const double whole = std::floor(config_.start_time);  // keeps nanoseconds exact for stamps of today
  return static_cast<std::int64_t>(whole) * 1000000000LL +
         std::llround(1e9 * (config_.start_time - whole + time(index)));
}

SimulatedFrame Simulator::groundTruth(int index) const {
  if (index < 0 || index >= frames()) {
    throw std::out_of_range("frame " + std::to_string(index) + " is outside 0 .. " + std::to_string(frames() - 1));
  }
  const double t = time(index);
  SimulatedFrame frame = describeExposure(motion_.pose, t, exposures_.exposure(t), static_cast<std::uint64_t>(index));
  frame.mid_exposure_ns = stampNs(index);
  return frame;
}

SimulatedFrame Simulator::render(int index) const {
  SimulatedFrame frame = groundTruth(index);
  const double t = time(index);
  renderImages(motion_.pose, t, sensor(exposures_.brightness(t), exposures_.gain(t)), frame);
  return frame;
}

cv::Mat1f Simulator::renderDepth(int index) const { return renderer_.depth(motion_.pose, time(index)); }

SimulatedFrame Simulator::renderExposure(const PoseFunction& pose, double t_mid, double exposure,
                                         std::uint64_t id) const {
  SimulatedFrame frame = describeExposure(pose, t_mid, exposure, id);
  renderImages(pose, t_mid, sensor(1.0, 1.0), frame);
  return frame;
}

SimulatedFrame Simulator::describeExposure(const PoseFunction& pose, double t_mid, double exposure,
                                           std::uint64_t id) const {
  SimulatedFrame frame;
  frame.id = id;
  frame.mid_exposure_ns = std::llround(1e9 * t_mid);
  frame.exposure = exposure;
  frame.exposure_hidden = config_.hide_exposure;
  frame.T_world_mid = pose(t_mid);
  frame.T_world_start = pose(t_mid - 0.5 * exposure);
  frame.T_world_end = pose(t_mid + 0.5 * exposure);
  frame.blur_px = blurAtTwoMetres(camera(), frame);
  return frame;
}

SensorConfig Simulator::sensor(double brightness, double gain) const {
  return {config_.gamma, gain * config_.noise, config_.vignette, brightness * config_.brightness};
}

void Simulator::renderImages(const PoseFunction& pose, double t_mid, const SensorConfig& sensor,
                             SimulatedFrame& frame) const {
  const std::uint64_t seeds =
      static_cast<std::uint64_t>(config_.scene_seed) * 1000003ULL + static_cast<std::uint64_t>(config_.trajectory_seed);
  const std::uint64_t stream = (seeds << 32) + 2 * frame.id;
  frame.blurred = expose(renderer_.integrate(pose, t_mid, frame.exposure), sensor, stream);
  if (config_.jpeg > 0) compress(config_.jpeg, frame);
  if (config_.sharp) frame.sharp = expose(renderer_.integrate(pose, t_mid, 0.0), sensor, stream + 1);
  if (config_.depth) frame.depth = renderer_.depth(pose, t_mid);
}

double blurAtTwoMetres(const PinholeCamera& camera, const SimulatedFrame& frame) {
  constexpr double kDepth = 2.0;  // [m]
  constexpr int kGrid = 9;        // points across and down
  const SE3 T_start_mid = frame.T_world_start.inverse() * frame.T_world_mid;
  const SE3 T_end_mid = frame.T_world_end.inverse() * frame.T_world_mid;
  double sum = 0.0;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const int column = i % kGrid;
    const int row = i / kGrid;
    const Eigen::Vector2d pixel((column + 0.5) * camera.width / kGrid - 0.5, (row + 0.5) * camera.height / kGrid - 0.5);
    const Eigen::Vector3d point = kDepth * camera.unproject(pixel);
    sum += (camera.project(T_end_mid * point) - camera.project(T_start_mid * point)).norm();
  }
  return sum / (kGrid * kGrid);
}

void renderSequence(const Simulator& simulator, SequenceSink& sink, const std::string& cache_folder,
                    const std::function<bool(int)>& progress) {
  std::optional<FrameCache> cache;
  if (!cache_folder.empty()) cache.emplace(cache_folder, simulator.config());
  for (int i = 0; i < simulator.frames(); ++i) {
    sink.write(cache ? renderCached(simulator, i, *cache) : simulator.render(i));
    if (progress && !progress(i + 1)) break;
  }
  sink.finish();
}

}  // namespace mba_vo
