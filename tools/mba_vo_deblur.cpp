// Deblurs the images of a recorded sequence along the motion that a run of mba_vo_offline found, or along the true one
// of a simulated sequence, and measures the result where sharp images are known.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <deque>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core/utils/logger.hpp>

#include "geometry_source.h"
#include "mba_vo/evaluation/image_quality.h"
#include "mba_vo/image/white_level.h"
#include "mba_vo/io/image_files.h"
#include "mba_vo/io/photometric_files.h"
#include "mba_vo/io/sequence.h"
#include "mba_vo/io/trajectory_writer.h"
#include "mba_vo/odometry/config_yaml.h"
#include "recording.h"

namespace {

namespace fs = std::filesystem;

struct Arguments {
  RecordingArguments recording;
  std::string run;
  std::string output;
  std::string config_file;
  std::string method = "trajectory";
  std::string sharp = "images_sharp";
  bool second_frame = false;
  std::size_t every = 1;
  std::size_t pictures = 4;
};

void describe(CLI::App& app, Arguments& a) {
  describeRecording(app, a.recording);
  app.add_option("--run", a.run,
                 "results of mba_vo_offline on it; without, the true motion and depths of a simulation");
  app.add_option("--output", a.output, "folder for the results, made if need be");
  app.add_option("--config", a.config_file, "YAML file with options; mapper.deblur and image are used");
  app.add_option("--method", a.method, "none, trajectory, onnx or folder, in place of mapper.deblur.method")
      ->capture_default_str();
  app.add_flag("--second-frame", a.second_frame,
               "a neighbouring frame is used too if it helps, as with mapper.deblur.trajectory.frames: 2");
  app.add_option("--sharp", a.sharp, "sub-folder with sharp images to compare with, if there is one")
      ->capture_default_str();
  app.add_option("--every", a.every, "only every so-manyth image")->capture_default_str()->check(CLI::Range(1, 100000));
  app.add_option("--pictures", a.pictures, "side-by-side pictures of the most blurred images")->capture_default_str();
}

constexpr std::size_t kReach = 2;  // frames before and after that may help

/// An image of the sequence with what is known about it.
struct Loaded {
  mba_vo::CameraImage image;
  std::optional<mba_vo::CameraImage> truth;
  std::optional<mba_vo::FrameMotion> motion;
  mba_vo::FrameConstPtr frame;  // null if the image cannot be read or its motion is unknown

  std::shared_ptr<const mba_vo::ImagePyramid> pyramid() const { return {frame, &frame->pyramid}; }
};

/// Input, result and truth (if known) of one image.
struct Picture {
  double blur_px;
  std::string name;
  cv::Mat side_by_side;
};

/// A result and the processor time it took [ms].
struct Timed {
  mba_vo::DeblurResult result;
  double milliseconds;
};

Timed deblurTimed(const mba_vo::Deblurrer& deblurrer, const mba_vo::DeblurInput& input) {
  const std::clock_t begin = std::clock();
  mba_vo::DeblurResult result = deblurrer.deblur(input);
  return {std::move(result), 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC};
}

class DeblurRun {
 public:
  DeblurRun(const Arguments& a, const mba_vo::OdometryConfig& config, std::unique_ptr<mba_vo::SequenceReader> blurred)
      : arguments_(a),
        blurred_(std::move(blurred)),
        builder_(blurred_->calibration(), mba_vo::loadPhotometricCalibration(config.image), config.image),
        white_level_(config.image.white_level),
        deblurrer_(mba_vo::makeDeblurrer(config.mapper.deblur)),
        two_frames_(config.mapper.deblur.trajectory.frames > 1),
        geometry_(a.run.empty() ? mba_vo::trueGeometry(a.recording.sequence) : mba_vo::estimatedGeometry(a.run)) {
    const std::string& sequence = a.recording.sequence;
    if (fs::is_directory(fs::path(sequence) / a.sharp)) sharp_ = mba_vo::openSequenceFolder(sequence, a.sharp);
    fs::create_directories(fs::path(a.output) / "images");
  }

  void run() {
    processAll();
    finish();
  }

 private:
  void processAll() {
    std::deque<Loaded> window;
    std::size_t first = 0;  // position of the window's first image
    const RecordingArguments& recording = arguments_.recording;
    const std::unique_ptr<mba_vo::ProgressBar> bar = progressBar(recording, *blurred_);
    for (std::size_t i = 0; i < recording.skip && blurred_->skip() && (!sharp_ || sharp_->skip()); ++i) continue;
    for (std::size_t i = 0; recording.frames == 0 || i < recording.frames; ++i) {
      while (first + window.size() <= i + kReach && load(window)) continue;
      if (first + kReach < i) {
        window.pop_front();
        ++first;
      }
      if (i - first >= window.size()) break;
      if (i % arguments_.every == 0 && window[i - first].frame) process(window, i - first);
      bar->update(recording.skip + i + 1);
    }
  }

  void finish() const {
    for (const Picture& p : pictures_) {
      save(fs::path(arguments_.output) / ("compare_" + p.name + ".png"), p.side_by_side);
    }
    mba_vo::writeFile((fs::path(arguments_.output) / "deblur.csv").string(),
                      [&](std::ostream& out) { mba_vo::writeDeblurRecords(records_, out); });
    mba_vo::writeDeblurTable(records_, std::cout);
    if (two_frames_) mba_vo::writeSecondFrameTable(records_, std::cout << "\n");
    if (records_.empty()) throw std::runtime_error("no image has a known motion");
  }

  mba_vo::FrameConstPtr build(const mba_vo::CameraImage& image) {
    builder_.setWhiteLevel(white_level_.of(image.image));
    return builder_.build(image.image, image.sequence, image.stamp_ns, image.mid_exposure_ns, image.exposure);
  }

  bool load(std::deque<Loaded>& window) {
    std::optional<mba_vo::CameraImage> image = blurred_->next();
    if (!image) return false;
    Loaded loaded;
    if (const std::optional<double> exposure = exposureOverride(arguments_.recording)) image->exposure = exposure;
    loaded.image = *image;
    if (sharp_) loaded.truth = sharp_->next();
    loaded.motion = geometry_->motion(image->mid_exposure_ns);
    if (loaded.motion && !image->image.empty()) loaded.frame = build(*image);
    window.push_back(std::move(loaded));
    return true;
  }

  mba_vo::DeblurInput makeInput(const Loaded& own) const {
    mba_vo::DeblurInput input;
    input.image = own.pyramid();
    input.sequence = own.image.sequence;
    input.depths = geometry_->depths(input.image->level(0).camera, *own.motion, own.image);
    input.motion = own.motion->trajectory;
    input.motion.T_reference_mid = mba_vo::SE3();
    input.other_velocity = own.motion->measured_velocity;
    return input;
  }

  /// Their brightness is taken to be that of the keyframe: no file of a run has it.
  static std::vector<mba_vo::DeblurNeighbour> neighboursOf(const std::deque<Loaded>& window, std::size_t own) {
    std::vector<mba_vo::DeblurNeighbour> neighbours;
    const mba_vo::FrameMotion& keyframe = *window[own].motion;
    for (std::size_t i = 0; i < window.size(); ++i) {
      const Loaded& other = window[i];
      if (i == own || !other.frame || other.motion->map_id != keyframe.map_id) continue;
      mba_vo::DeblurNeighbour neighbour;
      neighbour.image = other.pyramid();
      neighbour.sequence = other.image.sequence;
      neighbour.motion = other.motion->trajectory;
      neighbour.motion.T_reference_mid =
          keyframe.trajectory.T_reference_mid.inverse() * other.motion->trajectory.T_reference_mid;
      neighbours.push_back(neighbour);
    }
    return neighbours;
  }

  void process(const std::deque<Loaded>& window, std::size_t own) {
    const Loaded& loaded = window[own];
    mba_vo::DeblurInput input = makeInput(loaded);
    if (two_frames_) input.neighbours = neighboursOf(window, own);
    const Timed timed = deblurTimed(*deblurrer_, input);
    mba_vo::DeblurRecord record = makeRecord(timed, input.sequence);
    const cv::Mat1f before = input.image->level(0).intensity;
    const cv::Mat1f after = timed.result.image->level(0).intensity;
    std::vector<cv::Mat> row{before};
    std::optional<cv::Mat1f> sharp;
    if (loaded.truth && !loaded.truth->image.empty()) sharp = build(*loaded.truth)->pyramid.level(0).intensity;
    if (timed.result.neighbour.sequence) {
      input.neighbours.clear();
      const Timed alone = deblurTimed(*deblurrer_, input);
      record.milliseconds_alone = alone.milliseconds;
      row.push_back(alone.result.image->level(0).intensity);
      if (sharp) record.alone = mba_vo::compareImages(alone.result.image->level(0).intensity, *sharp);
    }
    row.push_back(after);
    if (sharp) {
      record.measured = true;
      record.before = mba_vo::compareImages(before, *sharp);
      record.after = mba_vo::compareImages(after, *sharp);
      row.push_back(*sharp);
    }
    records_.push_back(record);
    save(fs::path(arguments_.output) / "images" / (record.name + ".png"), after);
    keepPicture(record, row);
  }

  static mba_vo::DeblurRecord makeRecord(const Timed& timed, std::uint64_t sequence) {
    char name[32];
    std::snprintf(name, sizeof(name), "%06llu", static_cast<unsigned long long>(sequence));
    const mba_vo::DeblurResult& result = timed.result;
    mba_vo::DeblurRecord record;
    record.name = name;
    record.blur_px = static_cast<double>(result.blur_px);
    record.sharpened = result.sharpened;
    record.reason = result.reason;
    record.residual = static_cast<double>(result.residual);
    record.milliseconds = timed.milliseconds;
    if (result.neighbour.sequence) {
      record.second = static_cast<long long>(*result.neighbour.sequence) - static_cast<long long>(sequence);
    }
    record.second_reason = result.neighbour.reason;
    record.second_expected_gain = static_cast<double>(result.neighbour.expected_gain_db);
    record.second_shift_px = static_cast<double>(result.neighbour.shift_px);
    record.second_residual = static_cast<double>(result.neighbour.residual);
    return record;
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

  static void save(const fs::path& file, const cv::Mat& image) {
    cv::Mat eight_bit;
    image.convertTo(eight_bit, CV_8U);
    mba_vo::writePng(file, eight_bit);
  }

  Arguments arguments_;
  std::unique_ptr<mba_vo::SequenceReader> blurred_;
  std::unique_ptr<mba_vo::SequenceReader> sharp_;
  mba_vo::FrameBuilder builder_;
  mba_vo::WhiteLevel white_level_;
  std::unique_ptr<mba_vo::Deblurrer> deblurrer_;
  bool two_frames_;
  std::unique_ptr<mba_vo::GeometrySource> geometry_;
  std::vector<mba_vo::DeblurRecord> records_;
  std::vector<Picture> pictures_;
};

void run(const Arguments& a) {
  if (a.recording.sequence.empty() || a.output.empty()) {
    throw std::runtime_error("SEQUENCE and --output are needed; see --help");
  }
  mba_vo::OdometryConfig config = a.config_file.empty() ? mba_vo::OdometryConfig() : mba_vo::loadConfig(a.config_file);
  mba_vo::finalize(config);
  config.image.binning = 1;  // sharp images are as large as the camera's
  config.mapper.deblur.method = a.method;
  if (a.second_frame) config.mapper.deblur.trajectory.frames = 2;
  if (a.recording.row_time) config.image.row_time = *a.recording.row_time;
  std::unique_ptr<mba_vo::SequenceReader> reader = openSequence(a.recording);
  adoptWhatIsKnown(a.recording, config.image, std::cout);
  DeblurRun(a, config, std::move(reader)).run();
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
