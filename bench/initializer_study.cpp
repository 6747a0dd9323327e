// Starts the initialiser at every n-th frame of a sequence folder and compares what it finds with the ground truth.
//   initializer_study SEQUENCE [IMAGES_SUBFOLDER] [EVERY] [FIRST]
// One row per start: frames and seconds until success; seconds since the parallax first passed 2 %; the parallax of the
// map; the error of the poses after alignment of the scale (RMS, in % of the longest baseline); the largest rotation
// error; points; the blur of the reference; the time spent per frame.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>

#include "mba_vo/initialization/initializer.h"

namespace {

using mba_vo::SE3;

struct Sequence {
  std::vector<mba_vo::FrameConstPtr> frames;
  std::vector<SE3> T_world_camera;
  std::vector<double> blur_px;
};

mba_vo::PinholeCamera readCamera(const std::string& file) {
  std::ifstream in(file);
  mba_vo::PinholeCamera camera;
  std::string line;
  while (std::getline(in, line)) {
    std::sscanf(line.c_str(), "image_width: %d", &camera.width);
    std::sscanf(line.c_str(), "image_height: %d", &camera.height);
    std::sscanf(line.c_str(), "camera_matrix: {rows: 3, cols: 3, data: [%lf, 0.0, %lf, 0.0, %lf, %lf", &camera.fx,
                &camera.cx, &camera.fy, &camera.cy);
  }
  return camera;
}

std::vector<std::vector<double>> readRows(const std::string& file) {
  std::ifstream in(file);
  std::vector<std::vector<double>> rows;
  std::string line;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    rows.emplace_back();
    for (double x; words >> x;) rows.back().push_back(x);
  }
  return rows;
}

mba_vo::FrameConstPtr readFrame(const std::string& folder, const mba_vo::PinholeCamera& camera,
                                const std::vector<double>& time, bool sharp) {
  char name[32];
  std::snprintf(name, sizeof(name), "/%06d", static_cast<int>(time[0]));
  const std::string stem = folder + name;
  const bool webp = std::filesystem::exists(stem + ".webp");
  const cv::Mat image = cv::imread(stem + (webp ? ".webp" : ".jpg"), cv::IMREAD_GRAYSCALE);
  if (image.empty()) throw std::runtime_error("cannot read image " + stem);
  cv::Mat1f intensity;
  image.convertTo(intensity, CV_32F);
  auto frame = std::make_shared<mba_vo::Frame>();
  frame->sequence = static_cast<std::uint64_t>(time[0]);
  frame->stamp_ns = frame->mid_exposure_ns = static_cast<std::int64_t>(std::llround(1e9 * time[1]));
  if (sharp) frame->exposure = 0.0;
  if (!sharp && time[2] > 0.0) frame->exposure = 1e-3 * time[2];
  frame->pyramid = mba_vo::ImagePyramid(intensity, camera, 4);
  return frame;
}

Sequence readSequence(const std::string& folder, const std::string& images) {
  Sequence sequence;
  const mba_vo::PinholeCamera camera = readCamera(folder + "/camera.yaml");
  for (const auto& row : readRows(folder + "/times.txt")) {
    sequence.frames.push_back(readFrame(folder + "/" + images, camera, row, images == "images_sharp"));
  }
  for (const auto& row : readRows(folder + "/groundtruth.txt")) {
    sequence.T_world_camera.emplace_back(Eigen::Quaterniond(row[7], row[4], row[5], row[6]),
                                         Eigen::Vector3d(row[1], row[2], row[3]));
  }
  for (const auto& row : readRows(folder + "/blur_px.txt")) sequence.blur_px.push_back(row.back());
  return sequence;
}

struct Result {
  bool success = false;
  bool reversed = false;  // motion opposite to the true one
  int frames = 0;
  double seconds = 0.0;
  double since_parallax = 0.0;  // [s] after 2 % of parallax from the start
  double parallax = 0.0;
  double error_percent = 0.0;
  double max_rotation_deg = 0.0;
  double ms_per_frame = 0.0, max_ms = 0.0;
  std::size_t points = 0, poses = 0, reference = 0, reference_offset = 0;
  std::string reason;
};

void compare(const Sequence& sequence, const mba_vo::InitialMap& map, std::size_t start, std::size_t end, Result& r) {
  const SE3 T_reference_world = sequence.T_world_camera[map.reference->sequence].inverse();
  double dot = 0.0, square = 0.0, longest_estimate = 0.0;
  for (const auto& pose : map.poses) {
    const SE3 truth = T_reference_world * sequence.T_world_camera[pose.frame->sequence];
    dot += truth.translation().dot(pose.T_reference_frame.translation());
    square += pose.T_reference_frame.translation().squaredNorm();
    longest_estimate = std::max(longest_estimate, pose.T_reference_frame.translation().norm());
  }
  const double scale = dot / square;  // = the true median depth, the map's being 1
  double sum = 0.0, longest = 0.0;
  for (const auto& pose : map.poses) {
    const SE3 truth = T_reference_world * sequence.T_world_camera[pose.frame->sequence];
    sum += (truth.translation() - scale * pose.T_reference_frame.translation()).squaredNorm();
    longest = std::max(longest, truth.translation().norm());
    r.max_rotation_deg = std::max(r.max_rotation_deg,
                                  truth.rotation().angularDistance(pose.T_reference_frame.rotation()) * 180.0 / M_PI);
  }
  r.error_percent = 100.0 * std::sqrt(sum / static_cast<double>(map.poses.size())) / longest;
  r.parallax = longest_estimate;
  r.reversed = scale < 0.0;
  for (std::size_t i = start; i <= end; ++i) {
    const double moved =
        (sequence.T_world_camera[i].translation() - sequence.T_world_camera[start].translation()).norm();
    if (moved < 0.02 * std::abs(scale)) continue;
    r.since_parallax = sequence.frames[end]->midExposureSeconds() - sequence.frames[i]->midExposureSeconds();
    break;
  }
}

Result runFrom(const Sequence& sequence, std::size_t start) {
  mba_vo::Initializer initializer((mba_vo::InitializerConfig()));
  Result r;
  for (std::size_t i = start; i < sequence.frames.size(); ++i) {
    const auto before = std::chrono::steady_clock::now();
    const auto map = initializer.add(sequence.frames[i]);
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count();
    r.ms_per_frame += ms;
    r.max_ms = std::max(r.max_ms, ms);
    ++r.frames;
    r.seconds = sequence.frames[i]->midExposureSeconds() - sequence.frames[start]->midExposureSeconds();
    if (!map) continue;
    r.success = true;
    r.points = map->points.size();
    r.poses = map->poses.size();
    r.reference = map->reference->sequence;
    r.reference_offset = r.reference - start;
    compare(sequence, *map, start, i, r);
    break;
  }
  r.ms_per_frame /= r.frames;
  r.reason = initializer.reason();
  return r;
}

void print(const Sequence& sequence, std::size_t start, const Result& r) {
  if (!r.success) {
    std::printf("%5zu  none after %d frames (%.2f s): %s\n", start, r.frames, r.seconds, r.reason.c_str());
    return;
  }
  const double blur = r.reference < sequence.blur_px.size() ? sequence.blur_px[r.reference] : std::nan("");
  std::printf("%5zu %6d %6.2f %7.2f %8.1f %8.2f %8.2f %6zu %5zu %5zu %6.1f %6.1f %6.1f%s\n", start, r.frames, r.seconds,
              r.since_parallax, 100.0 * r.parallax, r.error_percent, r.max_rotation_deg, r.points, r.poses,
              r.reference_offset, blur, r.ms_per_frame, r.max_ms, r.reversed ? " REVERSED" : "");
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: initializer_study SEQUENCE [IMAGES_SUBFOLDER] [EVERY] [FIRST]\n";
    return 1;
  }
  cv::setNumThreads(1);
  const Sequence sequence = readSequence(argv[1], argc > 2 ? argv[2] : "images");
  const std::size_t every = argc > 3 ? std::stoul(argv[3]) : 10;
  const std::size_t first = argc > 4 ? std::stoul(argv[4]) : 0;
  std::printf("start frames seconds after2%% parallax%% error%% rot.deg points poses  ref  blur  ms/fr maxms\n");
  std::vector<double> errors, rotations, delays, times;
  int starts = 0;
  for (std::size_t start = first; start + 40 < sequence.frames.size(); start += every) {
    const Result r = runFrom(sequence, start);
    print(sequence, start, r);
    ++starts;
    if (!r.success) continue;
    errors.push_back(r.error_percent);
    rotations.push_back(r.max_rotation_deg);
    delays.push_back(r.since_parallax);
    times.push_back(r.ms_per_frame);
  }
  const auto below = [](const std::vector<double>& values, double limit) {
    return std::count_if(values.begin(), values.end(), [limit](double v) { return v < limit; });
  };
  std::printf(
      "%zu of %d starts succeed, %ld within 1.5 s of 2 %% parallax; error%% median %.2f 90%% %.2f max %.2f, %ld < 3; "
      "rotation deg median %.3f max %.3f; ms/frame %.1f\n",
      errors.size(), starts, static_cast<long>(below(delays, 1.5)), quantile(errors, 0.5), quantile(errors, 0.9),
      quantile(errors, 1.0), static_cast<long>(below(errors, 3.0)), quantile(rotations, 0.5), quantile(rotations, 1.0),
      quantile(times, 0.5));
  return 0;
}
