// Runs the odometry over a recorded sequence, a folder or a bag, and writes what it found. Needs no ROS master.
#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "mba_vo/io/calibrated_run.h"
#include "mba_vo/io/camera_memory.h"
#include "mba_vo/io/faulty_sequence.h"
#include "mba_vo/io/progress_bar.h"
#include "mba_vo/io/run_writer.h"
#include "mba_vo/io/trajectory_writer.h"
#include "mba_vo/odometry/config_yaml.h"
#include "report.h"
#ifdef MBA_VO_WITH_ROS
#include "mba_vo/ros/bag_reader.h"
#endif

namespace {

struct Arguments {
  std::string sequence;
  std::string output;
  std::string config_file;
  std::string images = "images";
  mba_vo::DepthFolder depth;
  std::string exposure = "auto";
  std::string image_topic;
  std::string camera_info_topic;
  std::string exposure_topic;
  std::string depth_topic;
  double depth_tolerance = 0.02;  // [s]
  std::string stamp_reference = "middle";
  std::optional<double> row_time;  // [s]
  std::size_t skip = 0;
  std::size_t frames = 0;
  std::vector<std::string> faults;
  unsigned fault_seed = 1;
  int reference_delay = 0;
  bool live = false;
  std::string machine_file;
  double slower = 1.0;
  bool rectified = false;
  bool deterministic = false;
  bool print_config = false;
};

/// "auto" or seconds.
std::string checkExposure(const std::string& text) {
  if (text == "auto") {
    return "";
  }
  constexpr double kLongest = 10.0;  // [s]
  std::size_t used = 0;
  double seconds = -1.0;
  try {
    seconds = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  const bool good = used == text.size() && seconds >= 0.0 && seconds <= kLongest;
  return good ? "" : "exposure '" + text + "': must be auto or 0 to 10 seconds";
}

void describe(CLI::App& app, Arguments& a) {
  app.add_option("SEQUENCE", a.sequence, "sequence folder (camera.yaml, times.txt, images) or .bag file");
  app.add_option("--output", a.output, "folder for the results, made if need be");
  app.add_option("--config", a.config_file, "YAML file with options; see --print-config");
  app.add_option("--images", a.images, "sub-folder with the images of a sequence folder")->capture_default_str();
  app.add_option(
      "--depth", a.depth.subfolder,
      "sub-folder with depth images of a sequence folder: the map then begins at once, and its scale is theirs");
  app.add_option("--depth-units", a.depth.units_per_metre, "units per metre of 16-bit depth images")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e6));
  app.add_option("--exposure", a.exposure, "auto = as recorded, or seconds for all images; 0 = treat as sharp")
      ->capture_default_str()
      ->check(checkExposure);
  app.add_option("--row-time", a.row_time,
                 "rolling shutter: seconds from one row to the next; default: image.row_time of the configuration")
      ->check(CLI::Range(-1e-3, 1e-3));
  app.add_option("--skip", a.skip, "images to leave out at the beginning")->capture_default_str();
  app.add_option("--frames", a.frames, "most images to take after these, 0 = all")->capture_default_str();
  app.add_option("--faults", a.faults,
                 "spoils the recording on purpose: all, or a list of black saturated covered frozen unreadable gap "
                 "forwards backwards restart brightness exposure kidnap")
      ->delimiter(',');
  app.add_option("--fault-seed", a.fault_seed, "decides what happens when")->capture_default_str();
  app.add_flag("--deterministic", a.deterministic, "bit-identical results run after run");
  app.add_option("--reference-delay", a.reference_delay,
                 "frames from a keyframe to the first that is aligned to it; 0 = ideal, about 12 = a live machine")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000));
  app.add_flag("--live", a.live,
               "as if it ran live: images arrive at their stamps, and work takes its time; deterministic");
  app.add_option("--machine", a.machine_file,
                 "YAML file with the times of the machine for --live; default: a laptop's");
  app.add_option("--slower", a.slower, "factor on these times")->capture_default_str()->check(CLI::Range(0.01, 100.0));
  app.add_flag("--print-config", a.print_config, "print the options with defaults, meaning and range, and stop");
  app.add_option("--image-topic", a.image_topic, "of the bag; found by type if there is only one");
  app.add_option("--camera-info-topic", a.camera_info_topic, "of the bag; found beside the image topic");
  app.add_option("--exposure-topic", a.exposure_topic, "of the bag; found by type if there is only one");
  app.add_option("--depth-topic", a.depth_topic,
                 "of the bag: depth images in metres or millimetres; none if not named");
  app.add_option("--depth-tolerance", a.depth_tolerance, "most seconds between the stamps of image and depth image")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--stamp-reference", a.stamp_reference, "what the bag's image stamps refer to: start, middle or end")
      ->capture_default_str()
      ->check(CLI::IsMember({"start", "middle", "end"}));
  app.add_flag("--rectified", a.rectified, "the bag's images are rectified already");
}

std::optional<double> exposureOverride(const Arguments& a) {
  return a.exposure == "auto" ? std::nullopt : std::optional<double>(std::stod(a.exposure));
}

#ifdef MBA_VO_WITH_ROS
/// A bag without exposures, given one for all images: only now can stamps of start or end be turned into mid-exposure.
class BagOfKnownExposure : public mba_vo::SequenceReader {
 public:
  BagOfKnownExposure(std::unique_ptr<SequenceReader> bag, double exposure, mba_vo::StampReference reference)
      : bag_(std::move(bag)), exposure_(exposure), reference_(reference) {}
  mba_vo::CameraCalibration calibration() const override { return bag_->calibration(); }
  std::size_t size() const override { return bag_->size(); }
  std::optional<mba_vo::CameraImage> next() override {
    std::optional<mba_vo::CameraImage> image = bag_->next();
    if (image && !image->exposure) {
      image->mid_exposure_ns = mba_vo::midExposure(image->stamp_ns, exposure_, reference_);
    }
    return image;
  }

 private:
  std::unique_ptr<SequenceReader> bag_;
  double exposure_;  // [s]
  mba_vo::StampReference reference_;
};

std::unique_ptr<mba_vo::SequenceReader> openBag(const Arguments& a) {
  mba_vo::BagTopics topics;
  topics.image = a.image_topic;
  topics.camera_info = a.camera_info_topic;
  topics.exposure = a.exposure_topic;
  topics.depth = a.depth_topic;
  topics.depth_tolerance = a.depth_tolerance;
  topics.stamp_reference = mba_vo::parseStampReference(a.stamp_reference);
  topics.rectified = a.rectified;
  auto bag = mba_vo::openBag(a.sequence, topics);
  const std::optional<double> exposure = exposureOverride(a);
  if (!exposure) {
    return bag;
  }
  return std::make_unique<BagOfKnownExposure>(std::move(bag), *exposure, topics.stamp_reference);
}
#else
std::unique_ptr<mba_vo::SequenceReader> openBag(const Arguments& a) {
  throw std::runtime_error(a.sequence + ": this program was built without ROS (MBA_VO_ROS=OFF) and cannot read bags");
}
#endif

std::unique_ptr<mba_vo::SequenceReader> openSequence(const Arguments& a) {
  if (!std::filesystem::exists(a.sequence)) {
    throw std::runtime_error(a.sequence + ": no such sequence folder or bag");
  }
  if (!std::filesystem::is_directory(a.sequence)) return openBag(a);
  return mba_vo::openSequenceFolder(a.sequence, a.images, a.depth);
}

/// What summary.yaml says about how the run was made.
std::vector<std::pair<std::string, std::string>> settingsOf(const Arguments& a) {
  return {{"sequence", a.sequence},
          {"images", a.images},
          {"depth", a.depth.subfolder + a.depth_topic},
          {"config", a.config_file},
          {"exposure", a.exposure},
          {"deterministic", a.deterministic ? "yes" : "no"},
          {"reference_delay_frames", std::to_string(a.reference_delay)},
          {"live", a.live ? "yes" : "no"}};
}

/// The recording itself, or spoilt in the ways that `faults` then tells.
std::unique_ptr<mba_vo::SequenceReader> openRecording(const Arguments& a, std::vector<mba_vo::FaultRecord>& faults) {
  std::unique_ptr<mba_vo::SequenceReader> reader = openSequence(a);
  if (a.faults.empty()) return reader;
  mba_vo::FaultConfig config{a.fault_seed, a.faults};
  if (a.faults.front() == "all") config.kinds.clear();
  auto faulty = std::make_unique<mba_vo::FaultySequence>(*reader, config);
  faults = faulty->records();
  return faulty;
}

/// The whole sequence, perhaps in several goes, with a progress bar each.
mba_vo::OfflineResult runOver(const Arguments& a, const mba_vo::OfflineOptions& options,
                              std::vector<mba_vo::FaultRecord>& faults) {
  std::unique_ptr<mba_vo::ProgressBar> bar;
  mba_vo::CalibratedRun run;
  run.open = [&] {
    auto reader = openRecording(a, faults);
    bar = std::make_unique<mba_vo::ProgressBar>(std::cerr, reader->size(), isatty(STDERR_FILENO) == 1);
    return reader;
  };
  run.progress = [&](std::size_t done) { bar->update(done); };
  run.onRestart = [&](const mba_vo::OfflineResult& result) {
    bar.reset();
    printLearnt(result);
  };
  return mba_vo::runCalibrated(run, options);
}

std::optional<mba_vo::Machine> machineOf(const Arguments& a) {
  if (!a.live) return std::nullopt;
  mba_vo::Machine machine;
  if (!a.machine_file.empty()) mba_vo::loadYaml(a.machine_file, machine);
  return machine.slowedBy(a.slower);
}

void run(const Arguments& a) {
  mba_vo::OfflineOptions options;
  if (!a.config_file.empty()) {
    options.config = mba_vo::loadConfig(a.config_file);
  }
  mba_vo::finalize(options.config);
  if (a.print_config) {
    mba_vo::writeConfig(options.config, std::cout);
    return;
  }
  if (a.sequence.empty() || a.output.empty()) {
    throw std::runtime_error("SEQUENCE and --output are needed; see --help");
  }
  options.config.mapper.deterministic = a.deterministic || a.live;
  options.live = machineOf(a);
  options.exposure = exposureOverride(a);
  options.skip = a.skip;
  options.frames = a.frames;
  options.reference_delay_frames = a.reference_delay;
  if (a.row_time) options.config.image.row_time = *a.row_time;
  mba_vo::CameraMemory memory(options.config.image);
  options.known = memory.recall(openSequence(a)->calibration());
  std::vector<mba_vo::FaultRecord> faults;
  const mba_vo::OfflineResult result = runOver(a, options, faults);
  mba_vo::writeRun(a.output, result, settingsOf(a));
  if (!a.faults.empty()) {
    const std::string file = (std::filesystem::path(a.output) / "faults.csv").string();
    mba_vo::writeFile(file, [&](std::ostream& out) { mba_vo::writeFaults(faults, out); });
  }
  if (result.settled_correction) memory.keep(*result.settled_correction);
  printCounts(result);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Runs the motion-blur-aware odometry over a recorded sequence.", "mba_vo_offline");
  Arguments arguments;
  describe(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "mba_vo_offline: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
