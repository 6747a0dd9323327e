// Is TRACKING honest on whole runs? Runs the odometry over rendered sequences with exact ground truth and counts, among
// all frames as they were first reported, how many of those reported TRACKING see the points of the map within 2 px of
// the truth.
//   honesty_study [--list] [--skip FRAMES] FOLDER...
// Two truths. The pose: the estimated points placed by the true pose relative to the keyframe, in units of the map by
// the similarity that aligns its whole trajectory; so that drift of scale counts as an error. The surface, where the
// folder has depth images: the point of the scene that the keyframe shows at the map point's pixel, which needs no
// scale. Two counts of each: frames whose points are right on average, and frames with 95 % of the points right.
// --list prints every frame; --skip leaves out the first ones, for another start.
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "mba_vo/odometry/config_yaml.h"
#include "point_errors.h"
#include "recorded_run.h"
#include "truth.h"

namespace mba_vo::study {
namespace {

constexpr double kRight = 2.0;  // [px]
constexpr double kShare = 0.95;

struct Options {
  bool list = false;
  int skip = 0;
  std::vector<std::string> folders;
};

Options parse(const std::vector<std::string>& arguments) {
  Options options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--list") {
      options.list = true;
    } else if (arguments[i] == "--skip" && i + 1 < arguments.size()) {
      options.skip = std::stoi(arguments[++i]);
    } else {
      options.folders.push_back(arguments[i]);
    }
  }
  return options;
}

/// TRACKING frames, and how many of them are right.
struct Count {
  int frames = 0, on_average = 0, nearly_all = 0;

  void add(const PointErrors& errors) {
    ++frames;
    on_average += errors.mean <= kRight ? 1 : 0;
    nearly_all += errors.right >= kShare ? 1 : 0;
  }
  void add(const Count& other) {
    frames += other.frames;
    on_average += other.on_average;
    nearly_all += other.nearly_all;
  }
  void print() const {
    if (frames == 0) {
      std::printf(" | |");
    } else {
      std::printf(" %.2f %% | %.2f %% |", 100.0 * on_average / frames, 100.0 * nearly_all / frames);
    }
  }
};

struct Result {
  Count by_pose, by_surface;
  int degraded = 0;

  void add(const Result& other) {
    by_pose.add(other.by_pose);
    by_surface.add(other.by_surface);
    degraded += other.degraded;
  }
  void print(const std::string& name) const {
    std::printf("| %s | %d |", name.c_str(), by_pose.frames);
    by_pose.print();
    by_surface.print();
    std::printf(" %d |\n", degraded);
    std::fflush(stdout);
  }
};

void list(const Reported& reported, const PointErrors& pose, const PointErrors& surface, double drift) {
  const TrackedFrame& tracked = *reported.tracked;
  std::printf(
      "  frame %3d by keyframe %u (map %u): pose %6.2f px %5.1f %%, surface %6.2f px %5.1f %%, scale off %+5.1f %%, "
      "expected %.2f px, parallax %5.1f px, blur %4.1f px, error %.2f px, seen %3.0f %%, patches %3d %s\n",
      static_cast<int>(tracked.frame->sequence), reported.reference->id.keyframe_id, reported.reference->id.map_id,
      pose.mean, 100.0 * pose.right, surface.mean, 100.0 * surface.right, 100.0 * drift, tracked.expected_error,
      tracked.measures.parallax_px, tracked.measures.blur_length_px, tracked.pixel_error,
      100.0 * tracked.measures.visible_fraction, tracked.points_used, tracked.reason.c_str());
}

Result study(const std::string& folder, const Options& options) {
  OdometryConfig config;
  finalize(config);
  config.mapper.deterministic = true;
  const RecordedRun run = runOver(folder, config, options.skip);
  const Truth truth(folder);
  const std::map<MapId, double> scales = truth.scales(run);
  Result result;
  for (const Reported& reported : run.reported) {
    const auto T_reference_frame = truth.T_reference_frame(reported);
    const auto scale = scales.find(reported.reference->id.map_id);
    if (!T_reference_frame || scale == scales.end()) continue;
    const PointErrors pose = errorsOfPose(reported, *T_reference_frame, scale->second);
    const cv::Mat1f depth = truth.depth(reported.reference->mid_exposure_ns);
    PointErrors surface;
    if (!depth.empty()) surface = errorsOfSurface(reported, *T_reference_frame, depth);
    if (options.list) {
      const double drift = depth.empty() ? 0.0 : scaleOfPoints(*reported.reference, depth) / scale->second - 1.0;
      list(reported, pose, surface, drift);
    }
    if (reported.tracked->status == TrackingStatus::kDegraded) {
      ++result.degraded;
      continue;
    }
    result.by_pose.add(pose);
    if (!depth.empty()) result.by_surface.add(surface);
  }
  return result;
}

int run(const Options& options) {
  std::printf(
      "| sequence | TRACKING | pose: on average | 95 %% of the points | surface: on average | "
      "95 %% of the points | DEGRADED |\n|---|---|---|---|---|---|---|\n");
  Result all;
  for (const std::string& folder : options.folders) {
    const Result result = study(folder, options);
    result.print(folder);
    all.add(result);
  }
  all.print("all");
  return 0;
}

}  // namespace
}  // namespace mba_vo::study

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  return mba_vo::study::run(mba_vo::study::parse({argv + 1, argv + argc}));
}
