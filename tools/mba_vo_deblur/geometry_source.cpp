#include "geometry_source.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

#include "mba_vo/evaluation/pose_file.h"
#include "mba_vo/io/points_file.h"

namespace mba_vo {
namespace {

std::int64_t nanoseconds(double seconds) { return std::llround(1e9 * seconds); }

/// exposure_trajectory.txt and points.txt of a run.
class EstimatedGeometry final : public GeometrySource {
 public:
  explicit EstimatedGeometry(const std::string& folder)
      : motion_(exposuresOf(folder)), points_(readPoints(folder + "/points.txt")) {}
  std::optional<FrameMotion> motion(std::int64_t mid_exposure_ns) const override { return motion_.at(mid_exposure_ns); }
  std::vector<DepthSample> depths(const PinholeCamera& camera, const FrameMotion& motion,
                                  const CameraImage& image) const override {
    return depthsInFrame(points_, camera, motion, image.mid_exposure_ns);
  }

 private:
  static std::vector<RecordedExposure> exposuresOf(const std::string& folder) {
    std::vector<RecordedExposure> exposures;
    for (const PoseRecord& p : readPoseFile(folder + "/exposure_trajectory.txt")) {
      exposures.push_back({nanoseconds(p.time), static_cast<MapId>(p.map),
                           ExposureTrajectory::fromStartAndEnd(p.exposure->T_world_start, p.exposure->T_world_end,
                                                               p.exposure->exposure)});
    }
    return exposures;
  }
  RecordedMotion motion_;
  std::vector<MapPoint> points_;
};

/// groundtruth.txt, groundtruth_exposure.txt and depth/ of a simulated sequence.
class TrueGeometry final : public GeometrySource {
 public:
  explicit TrueGeometry(const std::string& folder)
      : folder_(folder),
        mid_(readPoseFile(folder + "/groundtruth.txt")),
        exposures_(readPoseFile(folder + "/groundtruth_exposure.txt")) {
    if (mid_.size() != exposures_.size() || !exposures_.front().exposure) {
      throw std::runtime_error(folder + ": groundtruth.txt and groundtruth_exposure.txt do not belong together");
    }
  }
  /// The motion at constant acceleration through the true poses at start, middle and end.
  std::optional<FrameMotion> motion(std::int64_t mid_exposure_ns) const override {
    for (std::size_t i = 0; i < mid_.size(); ++i) {
      constexpr std::int64_t kSameTime = 1000;  // [ns]
      if (std::llabs(nanoseconds(mid_[i].time) - mid_exposure_ns) > kSameTime) continue;
      const SE3 T_mid_world = mid_[i].T_world_camera.inverse();
      const Vector6 start = (T_mid_world * exposures_[i].exposure->T_world_start).log();
      const Vector6 end = (T_mid_world * exposures_[i].exposure->T_world_end).log();
      const double exposure = exposures_[i].exposure->exposure;
      FrameMotion motion;
      motion.trajectory = {mid_[i].T_world_camera, (end - start) / exposure, exposure,
                           4.0 / (exposure * exposure) * (start + end)};
      motion.measured_velocity = motion.trajectory.velocity;
      return motion;
    }
    return std::nullopt;
  }
  std::vector<DepthSample> depths(const PinholeCamera& /*camera*/, const FrameMotion& /*motion*/,
                                  const CameraImage& image) const override {
    constexpr int kSpacing = 6;                // [px]
    constexpr float kUnitsPerMetre = 5000.0F;  // of the depth images
    constexpr float kBeyond = 1.0F / 14.0F;    // inverse depth where the image has none [1/m]
    char name[32];
    std::snprintf(name, sizeof(name), "/depth/%06llu.png", static_cast<unsigned long long>(image.sequence));
    const cv::Mat1w depth = cv::imread(folder_ + name, cv::IMREAD_UNCHANGED);
    if (depth.empty()) throw std::runtime_error(folder_ + name + ": cannot be read (simulate with --depth)");
    std::vector<DepthSample> samples;
    for (int y = kSpacing / 2; y < depth.rows; y += kSpacing) {
      for (int x = kSpacing / 2; x < depth.cols; x += kSpacing) {
        const auto units = static_cast<float>(depth(y, x));
        samples.push_back(
            {{static_cast<float>(x), static_cast<float>(y)}, units > 0.0F ? kUnitsPerMetre / units : kBeyond});
      }
    }
    return samples;
  }

 private:
  std::string folder_;
  std::vector<PoseRecord> mid_;
  std::vector<PoseRecord> exposures_;
};

}  // namespace

std::unique_ptr<GeometrySource> estimatedGeometry(const std::string& run_folder) {
  return std::make_unique<EstimatedGeometry>(run_folder);
}

std::unique_ptr<GeometrySource> trueGeometry(const std::string& sequence_folder) {
  return std::make_unique<TrueGeometry>(sequence_folder);
}

}  // namespace mba_vo
