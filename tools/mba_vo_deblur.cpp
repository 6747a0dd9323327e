// Deblurs the images of a recorded sequence along the motion that a run of mba_vo_offline found, or along the true one
// of a simulated sequence, and measures the result where sharp images are known.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

#include "mba_vo/evaluation/image_quality.h"
#include "mba_vo/evaluation/pose_file.h"
#include "mba_vo/io/photometric_files.h"
#include "mba_vo/io/points_file.h"
#include "mba_vo/io/recorded_motion.h"
#include "mba_vo/io/sequence.h"
#include "mba_vo/io/trajectory_writer.h"
#include "mba_vo/odometry/config_yaml.h"

namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string sequence;
  std::string run;
  std::string output;
  std::string config_file;
  std::string method = "trajectory";
  std::string images = "images";
  std::string sharp = "images_sharp";
  std::size_t every = 1;
  std::size_t pictures = 4;
};

void describe(CLI::App& app, Arguments& a) {
  app.add_option("SEQUENCE", a.sequence, "sequence folder (camera.yaml, times.txt, images)")->required();
  app.add_option("--run", a.run,
                 "results of mba_vo_offline on it; without, the true motion and depths of a simulation");
  app.add_option("--output", a.output, "folder for the results, made if need be")->required();
  app.add_option("--config", a.config_file, "YAML file with options; mapper.deblur and image are used");
  app.add_option("--method", a.method, "none, trajectory, onnx or folder, in place of mapper.deblur.method")
      ->capture_default_str();
  app.add_option("--images", a.images, "sub-folder with the blurred images")->capture_default_str();
  app.add_option("--sharp", a.sharp, "sub-folder with sharp images to compare with, if there is one")
      ->capture_default_str();
  app.add_option("--every", a.every, "only every so-manyth image")->capture_default_str()->check(CLI::Range(1, 100000));
  app.add_option("--pictures", a.pictures, "side-by-side pictures of the most blurred images")->capture_default_str();
}

std::int64_t nanoseconds(double seconds) { return std::llround(1e9 * seconds); }

/// Where motion and depths of a frame come from.
class GeometrySource {
 public:
  virtual ~GeometrySource() = default;
  virtual std::optional<mba_vo::FrameMotion> motion(std::int64_t mid_exposure_ns) const = 0;
  virtual std::vector<mba_vo::DepthSample> depths(const mba_vo::PinholeCamera& camera,
                                                  const mba_vo::FrameMotion& motion,
                                                  const mba_vo::SequenceImage& image) const = 0;
};

/// exposure_trajectory.txt and points.txt of a run.
class EstimatedGeometry final : public GeometrySource {
 public:
  explicit EstimatedGeometry(const std::string& folder)
      : motion_(exposuresOf(folder)), points_(mba_vo::readPoints(folder + "/points.txt")) {}
  std::optional<mba_vo::FrameMotion> motion(std::int64_t mid_exposure_ns) const override {
    return motion_.at(mid_exposure_ns);
  }
  std::vector<mba_vo::DepthSample> depths(const mba_vo::PinholeCamera& camera, const mba_vo::FrameMotion& motion,
                                          const mba_vo::SequenceImage& image) const override {
    return mba_vo::depthsInFrame(points_, camera, motion, image.mid_exposure_ns);
  }

 private:
  static std::vector<mba_vo::RecordedExposure> exposuresOf(const std::string& folder) {
    std::vector<mba_vo::RecordedExposure> exposures;
    for (const mba_vo::PoseRecord& p : mba_vo::readPoseFile(folder + "/exposure_trajectory.txt")) {
      exposures.push_back({nanoseconds(p.time), static_cast<mba_vo::MapId>(p.map),
                           mba_vo::ExposureTrajectory::fromStartAndEnd(p.exposure->T_world_start,
                                                                       p.exposure->T_world_end, p.exposure->exposure)});
    }
    return exposures;
  }
  mba_vo::RecordedMotion motion_;
  std::vector<mba_vo::MapPoint> points_;
};

/// groundtruth.txt, groundtruth_exposure.txt and depth/ of a simulated sequence.
class TrueGeometry final : public GeometrySource {
 public:
  explicit TrueGeometry(const std::string& folder)
      : folder_(folder),
        mid_(mba_vo::readPoseFile(folder + "/groundtruth.txt")),
        exposures_(mba_vo::readPoseFile(folder + "/groundtruth_exposure.txt")) {
    if (mid_.size() != exposures_.size() || !exposures_.front().exposure) {
      throw std::runtime_error(folder + ": groundtruth.txt and groundtruth_exposure.txt do not belong together");
    }
  }
  /// The motion at constant acceleration through the true poses at start, middle and end.
  std::optional<mba_vo::FrameMotion> motion(std::int64_t mid_exposure_ns) const override {
    for (std::size_t i = 0; i < mid_.size(); ++i) {
      constexpr std::int64_t kSameTime = 1000;  // [ns]
      if (std::llabs(nanoseconds(mid_[i].time) - mid_exposure_ns) > kSameTime) continue;
      const mba_vo::SE3 T_mid_world = mid_[i].T_world_camera.inverse();
      const mba_vo::Vector6 start = (T_mid_world * exposures_[i].exposure->T_world_start).log();
      const mba_vo::Vector6 end = (T_mid_world * exposures_[i].exposure->T_world_end).log();
      const double exposure = exposures_[i].exposure->exposure;
      mba_vo::FrameMotion motion;
      motion.trajectory = {mid_[i].T_world_camera, (end - start) / exposure, exposure,
                           4.0 / (exposure * exposure) * (start + end)};
      motion.measured_velocity = motion.trajectory.velocity;
      return motion;
    }
    return std::nullopt;
  }
  std::vector<mba_vo::DepthSample> depths(const mba_vo::PinholeCamera& /*camera*/,
                                          const mba_vo::FrameMotion& /*motion*/,
                                          const mba_vo::SequenceImage& image) const override {
    constexpr int kSpacing = 6;                // [px]
    constexpr float kUnitsPerMetre = 5000.0F;  // of the depth images
    constexpr float kBeyond = 1.0F / 14.0F;    // inverse depth where the image has none [1/m]
    char name[32];
    std::snprintf(name, sizeof(name), "/depth/%06llu.png", static_cast<unsigned long long>(image.sequence));
    const cv::Mat1w depth = cv::imread(folder_ + name, cv::IMREAD_UNCHANGED);
    if (depth.empty()) throw std::runtime_error(folder_ + name + ": cannot be read (simulate with --depth)");
    std::vector<mba_vo::DepthSample> samples;
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
  std::vector<mba_vo::PoseRecord> mid_;
  std::vector<mba_vo::PoseRecord> exposures_;
};

/// Input, result and truth (if known) of one image.
struct Picture {
  double blur_px;
  std::string name;
  cv::Mat side_by_side;
};

class DeblurRun {
 public:
  DeblurRun(const Arguments& a, const mba_vo::OdometryConfig& config)
      : arguments_(a),
        blurred_(mba_vo::openSequenceFolder(a.sequence, a.images)),
        builder_(blurred_->calibration(),
                 mba_vo::loadPhotometricCalibration(config.image.response_file, config.image.vignette_file),
                 config.image),
        deblurrer_(mba_vo::makeDeblurrer(config.mapper.deblur)) {
    if (fs::is_directory(fs::path(a.sequence) / a.sharp)) sharp_ = mba_vo::openSequenceFolder(a.sequence, a.sharp);
    if (a.run.empty()) {
      geometry_ = std::make_unique<TrueGeometry>(a.sequence);
    } else {
      geometry_ = std::make_unique<EstimatedGeometry>(a.run);
    }
    fs::create_directories(fs::path(a.output) / "images");
  }

  void run() {
    for (std::size_t i = 0;; ++i) {
      const std::optional<mba_vo::SequenceImage> image = blurred_->next();
      const std::optional<mba_vo::SequenceImage> truth = sharp_ ? sharp_->next() : std::nullopt;
      if (!image) break;
      if (i % arguments_.every == 0 && !image->image.empty()) process(*image, truth);
    }
    savePictures();
    mba_vo::writeFile((fs::path(arguments_.output) / "deblur.csv").string(),
                      [&](std::ostream& out) { mba_vo::writeDeblurRecords(records_, out); });
    mba_vo::writeDeblurTable(records_, std::cout);
    if (records_.empty()) throw std::runtime_error("no image has a known motion");
  }

 private:
  mba_vo::FrameConstPtr build(const mba_vo::SequenceImage& image) const {
    return builder_.build(image.image, image.sequence, image.stamp_ns, image.mid_exposure_ns, image.exposure);
  }

  void process(const mba_vo::SequenceImage& image, const std::optional<mba_vo::SequenceImage>& truth) {
    const std::optional<mba_vo::FrameMotion> motion = geometry_->motion(image.mid_exposure_ns);
    if (!motion) return;
    const mba_vo::FrameConstPtr frame = build(image);
    mba_vo::DeblurInput input;
    input.image = std::shared_ptr<const mba_vo::ImagePyramid>(frame, &frame->pyramid);
    input.sequence = image.sequence;
    input.depths = geometry_->depths(frame->pyramid.level(0).camera, *motion, image);
    input.motion = motion->trajectory;
    input.motion.T_reference_mid = mba_vo::SE3();
    input.other_velocity = motion->measured_velocity;
    const auto begin = std::chrono::steady_clock::now();
    const mba_vo::DeblurResult result = deblurrer_->deblur(input);
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;

    char name[32];
    std::snprintf(name, sizeof(name), "%06llu", static_cast<unsigned long long>(image.sequence));
    mba_vo::DeblurRecord record;
    record.name = name;
    record.blur_px = static_cast<double>(result.blur_px);
    record.sharpened = result.sharpened;
    record.reason = result.reason;
    record.residual = static_cast<double>(result.residual);
    record.milliseconds = time.count();
    const cv::Mat1f before = input.image->level(0).intensity;
    const cv::Mat1f after = result.image->level(0).intensity;
    std::vector<cv::Mat> row{before, after};
    if (truth && !truth->image.empty()) {
      const cv::Mat1f sharp = build(*truth)->pyramid.level(0).intensity;
      record.measured = true;
      record.before = mba_vo::compareImages(before, sharp);
      record.after = mba_vo::compareImages(after, sharp);
      row.emplace_back(sharp);
    }
    records_.push_back(record);
    save(fs::path(arguments_.output) / "images" / (record.name + ".png"), after);
    keepPicture(record, row);
  }

  void keepPicture(const mba_vo::DeblurRecord& record, const std::vector<cv::Mat>& row) {
    if (!record.sharpened || arguments_.pictures == 0) return;
    cv::Mat side_by_side;
    cv::hconcat(row, side_by_side);
    pictures_.push_back({record.blur_px, record.name, side_by_side});
    std::sort(pictures_.begin(), pictures_.end(),
              [](const Picture& a, const Picture& b) { return a.blur_px > b.blur_px; });
    if (pictures_.size() > arguments_.pictures) pictures_.pop_back();
  }

  void savePictures() const {
    for (const Picture& p : pictures_)
      save(fs::path(arguments_.output) / ("compare_" + p.name + ".png"), p.side_by_side);
  }

  static void save(const fs::path& file, const cv::Mat& image) {
    cv::Mat eight_bit;
    image.convertTo(eight_bit, CV_8U);
    if (!cv::imwrite(file.string(), eight_bit)) throw std::runtime_error(file.string() + ": cannot be written");
  }

  Arguments arguments_;
  std::unique_ptr<mba_vo::SequenceReader> blurred_;
  std::unique_ptr<mba_vo::SequenceReader> sharp_;
  mba_vo::FrameBuilder builder_;
  std::unique_ptr<mba_vo::Deblurrer> deblurrer_;
  std::unique_ptr<GeometrySource> geometry_;
  std::vector<mba_vo::DeblurRecord> records_;
  std::vector<Picture> pictures_;
};

void run(const Arguments& a) {
  mba_vo::OdometryConfig config;
  if (!a.config_file.empty()) config = mba_vo::loadConfig(a.config_file);
  mba_vo::finalize(config);
  config.mapper.deblur.method = a.method;
  DeblurRun(a, config).run();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    CLI::App app("Deblurs the images of a sequence along a known motion, and measures the result.", "mba_vo_deblur");
    Arguments arguments;
    describe(app, arguments);
    CLI11_PARSE(app, argc, argv);
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_ERROR);
    run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "mba_vo_deblur: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
