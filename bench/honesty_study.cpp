// Is TRACKING honest on whole runs? Runs the odometry over sequence folders with exact ground truth and counts, among
// all frames as they were first reported, how many of those reported TRACKING see the points of the map within 2 px of
// the truth.
//   honesty_study FOLDER...
// The truth about a frame is its true pose relative to the true pose of the keyframe that it was aligned to, in units
// of the map by the similarity that aligns the whole trajectory. Two counts: frames whose points are right on average,
// and frames with 95 % of the points right, which also fail where the scale has drifted and some points are near.
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "mba_vo/evaluation/alignment.h"
#include "mba_vo/evaluation/association.h"
#include "mba_vo/evaluation/pose_file.h"
#include "mba_vo/image/frame_builder.h"
#include "mba_vo/io/sequence.h"
#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/odometry.h"

namespace mba_vo {
namespace {

constexpr double kRight = 2.0;  // [px]
constexpr double kShare = 0.95;
constexpr double kSameTime = 1e-3;  // [s]

/// A frame as it was reported.
struct Reported {
  TrackedFrameConstPtr tracked;
  ReferenceConstPtr reference;
};

struct Run {
  std::vector<Reported> reported;  // with a pose
  std::vector<TrajectoryEntry> trajectory;
};

Run runOver(const std::string& folder) {
  OdometryConfig config;
  finalize(config);
  config.mapper.deterministic = true;
  const auto reader = openSequenceFolder(folder, "images");
  const FrameBuilder builder(reader->calibration(), {}, config.image);
  Odometry odometry(config, 0);
  std::map<std::tuple<MapId, KeyframeId, std::uint32_t>, ReferenceConstPtr> references;
  std::map<std::uint64_t, bool> seen;  // frames that were reported already
  Run run;
  const auto take = [&](const OdometryResult& result) {
    const auto report = [&](const TrackedFrameConstPtr& tracked) {
      if (!tracked || !tracked->tracked() || std::exchange(seen[tracked->frame->sequence], true)) return;
      const ReferenceId& id = tracked->reference;
      run.reported.push_back({tracked, references.at({id.map_id, id.keyframe_id, id.revision})});
    };
    // The references of the very same call are those that its later results were aligned to.
    for (const MapperOutput& output : result.mapping) {
      if (!output.reference) continue;
      const ReferenceId& id = output.reference->id;
      references[{id.map_id, id.keyframe_id, id.revision}] = output.reference;
    }
    for (const TrackedFrameConstPtr& late : result.late) report(late);
    report(result.tracked);
  };
  while (const std::optional<SequenceImage> image = reader->next()) {
    take(odometry.process(
        builder.build(image->image, image->sequence, image->stamp_ns, image->mid_exposure_ns, image->exposure)));
  }
  take(odometry.finish());
  run.trajectory = odometry.trajectory();
  return run;
}

/// True poses by time.
class Truth {
 public:
  Truth(const std::string& folder, const std::vector<TrajectoryEntry>& trajectory)
      : poses_(readPoseFile(folder + "/groundtruth.txt")) {
    std::vector<Eigen::Vector3d> estimated;
    std::vector<Eigen::Vector3d> truth;
    for (const TrajectoryEntry& entry : trajectory) {
      const auto pose = at(entry.mid_exposure_ns);
      if (!pose || entry.map_id != trajectory.back().map_id) continue;
      estimated.push_back(entry.trajectory.T_reference_mid.translation());
      truth.push_back(pose->translation());
    }
    scale_ = alignPositions(estimated, truth, AlignmentMode::kSim3).scale;
  }

  std::optional<SE3> at(std::int64_t ns) const {
    const double time = 1e-9 * static_cast<double>(ns);
    for (const PoseRecord& pose : poses_) {
      if (std::abs(pose.time - time) < kSameTime) return pose.T_world_camera;
    }
    return std::nullopt;
  }
  /// In units of the map.
  std::optional<SE3> T_reference_frame(const Reported& reported) const {
    const auto reference = at(reported.reference->mid_exposure_ns);
    const auto frame = at(reported.tracked->frame->mid_exposure_ns);
    if (!reference || !frame) return std::nullopt;
    const SE3 T = reference->inverse() * *frame;
    return SE3(T.rotation(), T.translation() / scale_);
  }

 private:
  std::vector<PoseRecord> poses_;
  double scale_ = 1.0;  // true over estimated length
};

/// Of the points of the map in view, against the truth.
struct PointErrors {
  double mean = 0.0;  // [px]
  double share_right = 0.0;
};

PointErrors pointErrors(const Reported& reported, const SE3& T_reference_frame) {
  const PinholeCamera& camera = reported.reference->pyramid->level(0).camera;
  const SE3 T_frame_reference = T_reference_frame.inverse();
  const SE3 T_estimated = reported.tracked->trajectory.T_reference_mid.inverse();
  int in_view = 0;
  int right = 0;
  double sum = 0.0;
  for (const ReferencePoint& p : reported.reference->points) {
    const Eigen::Vector3d point = camera.unproject(p.pixel.cast<double>()) / static_cast<double>(p.inverse_depth);
    const Eigen::Vector3d truth = T_frame_reference * point;
    const Eigen::Vector3d estimate = T_estimated * point;
    if (truth.z() <= 0.0 || !camera.contains(camera.project(truth))) continue;
    const double error = estimate.z() > 0.0 ? (camera.project(estimate) - camera.project(truth)).norm()
                                            : static_cast<double>(camera.width);
    ++in_view;
    right += error <= kRight ? 1 : 0;
    sum += error;
  }
  if (in_view == 0) return {static_cast<double>(camera.width), 0.0};
  return {sum / in_view, static_cast<double>(right) / in_view};
}

struct Counts {
  int tracking = 0, right = 0, nearly_all_right = 0, degraded = 0;
};

Counts study(const std::string& folder) {
  const Run run = runOver(folder);
  const Truth truth(folder, run.trajectory);
  Counts counts;
  for (const Reported& reported : run.reported) {
    const auto T_reference_frame = truth.T_reference_frame(reported);
    if (!T_reference_frame) continue;
    if (reported.tracked->status == TrackingStatus::kDegraded) {
      ++counts.degraded;
      continue;
    }
    const PointErrors errors = pointErrors(reported, *T_reference_frame);
    ++counts.tracking;
    counts.right += errors.mean <= kRight ? 1 : 0;
    counts.nearly_all_right += errors.share_right >= kShare ? 1 : 0;
  }
  return counts;
}

void print(const std::string& name, const Counts& counts) {
  const auto percent = [&](int part) { return counts.tracking > 0 ? 100.0 * part / counts.tracking : 0.0; };
  std::printf("| %s | %d | %.2f %% | %.2f %% | %d |\n", name.c_str(), counts.tracking, percent(counts.right),
              percent(counts.nearly_all_right), counts.degraded);
  std::fflush(stdout);
}

}  // namespace
}  // namespace mba_vo

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  std::printf("| sequence | TRACKING | points within 2 px on average | 95 %% of the points | DEGRADED |\n");
  std::printf("|---|---|---|---|---|\n");
  mba_vo::Counts all;
  for (int i = 1; i < argc; ++i) {
    const mba_vo::Counts counts = mba_vo::study(argv[i]);
    mba_vo::print(argv[i], counts);
    all.tracking += counts.tracking;
    all.right += counts.right;
    all.nearly_all_right += counts.nearly_all_right;
    all.degraded += counts.degraded;
  }
  mba_vo::print("all", all);
  return 0;
}
