#include "truth.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <opencv2/imgcodecs.hpp>

#include "mba_vo/evaluation/alignment.h"
#include "mba_vo/io/times_file.h"
#include "mba_vo/simulation/folder_sink.h"

namespace mba_vo::study {
namespace {

constexpr double kSameTime = 1e-3;  // [s]
constexpr std::size_t kLeastPoses = 3;

}  // namespace

Truth::Truth(const std::string& folder) : folder_(folder), poses_(readPoseFile(folder + "/groundtruth.txt")) {
  for (const ImageTime& image : readTimesFile(folder + "/times.txt")) ids_[image.mid_exposure_ns] = image.id;
}

std::optional<SE3> Truth::T_world_camera(std::int64_t ns) const {
  const double time = 1e-9 * static_cast<double>(ns);
  for (const PoseRecord& pose : poses_) {
    if (std::abs(pose.time - time) < kSameTime) return pose.T_world_camera;
  }
  return std::nullopt;
}

std::optional<SE3> Truth::T_reference_frame(const Reported& reported) const {
  const auto reference = T_world_camera(reported.reference->mid_exposure_ns);
  const auto frame = T_world_camera(reported.tracked->frame->mid_exposure_ns);
  if (!reference || !frame) return std::nullopt;
  return reference->inverse() * *frame;
}

std::map<MapId, double> Truth::scales(const RecordedRun& run) const {
  struct Positions {
    std::vector<Eigen::Vector3d> estimated, truth;
  };
  std::map<MapId, Positions> maps;
  const auto add = [&](MapId map, std::int64_t ns, const SE3& T_map_camera) {
    const auto truth = T_world_camera(ns);
    if (!truth) return;
    maps[map].estimated.push_back(T_map_camera.translation());
    maps[map].truth.push_back(truth->translation());
  };
  for (const TrajectoryEntry& entry : run.trajectory) {
    add(entry.map_id, entry.mid_exposure_ns, entry.trajectory.T_reference_mid);
  }
  const std::map<MapId, Positions> kept = maps;
  // A map that was given up has left no trajectory: what was reported of it then.
  for (const Reported& reported : run.reported) {
    const MapId map = reported.reference->id.map_id;
    if (kept.count(map) > 0) continue;
    add(map, reported.tracked->frame->mid_exposure_ns,
        reported.reference->T_map_reference * reported.tracked->trajectory.T_reference_mid);
  }
  std::map<MapId, double> scales;
  for (const auto& [map, positions] : maps) {
    if (positions.truth.size() < kLeastPoses) continue;
    scales[map] = alignPositions(positions.estimated, positions.truth, AlignmentMode::kSim3).scale;
  }
  return scales;
}

cv::Mat1f Truth::depth(std::int64_t ns) const {
  const auto found = ids_.find(ns);
  if (found == ids_.end()) return {};
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "/depth/%06llu.png", static_cast<unsigned long long>(found->second));
  const std::string file = folder_ + name.data();
  cv::Mat1f depth;
  if (!std::filesystem::exists(file)) return depth;
  const cv::Mat image = cv::imread(file, cv::IMREAD_UNCHANGED);
  if (!image.empty()) image.convertTo(depth, CV_32F, 1.0 / kDepthUnitsPerMetre);
  return depth;
}

}  // namespace mba_vo::study
