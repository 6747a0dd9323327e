// Runs the odometry over a recorded sequence, a folder or a bag, and writes what it found. Needs no ROS master.
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
#include "mba_vo/io/map_file.h"
#include "mba_vo/io/run_writer.h"
#include "mba_vo/io/trajectory_writer.h"
#include "mba_vo/odometry/config_yaml.h"
#include "recording.h"
#include "report.h"

namespace {

struct Arguments {
  RecordingArguments recording;
  std::string output;
  std::string config_file;
  std::string map_file;
  std::string save_map_file;
  bool localize_only = false;
  std::vector<std::string> faults;
  unsigned fault_seed = 1;
  int reference_delay = 0;
  bool live = false;
  std::string machine_file;
  double slower = 1.0;
  bool deterministic = false;
  bool print_config = false;
};

void describe(CLI::App& app, Arguments& a) {
  describeRecording(app, a.recording);
  app.add_option("--output", a.output, "folder for the results, made if need be");
  app.add_option("--config", a.config_file, "YAML file with options; see --print-config");
  app.add_option("--map", a.map_file,
                 "map of an earlier run: the camera is looked for in it, and the run goes on there");
  app.add_flag("--localize-only", a.localize_only, "with --map: it stays as it is, and is looked in until it is found");
  app.add_option("--save-map", a.save_map_file, "file for the map, for --map of a later run");
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
}

/// What summary.yaml says about how the run was made.
std::vector<std::pair<std::string, std::string>> settingsOf(const Arguments& a) {
  return {{"sequence", a.recording.sequence},
          {"images", a.recording.images},
          {"depth", a.recording.depth.subfolder + a.recording.depth_topic},
          {"config", a.config_file},
          {"map", a.map_file},
          {"exposure", a.recording.exposure},
          {"deterministic", a.deterministic ? "yes" : "no"},
          {"reference_delay_frames", std::to_string(a.reference_delay)},
          {"live", a.live ? "yes" : "no"}};
}

/// The recording itself, or spoilt in the ways that `faults` then tells.
std::unique_ptr<mba_vo::SequenceReader> openRecording(const Arguments& a, std::vector<mba_vo::FaultRecord>& faults) {
  std::unique_ptr<mba_vo::SequenceReader> reader = openSequence(a.recording);
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
    bar = progressBar(a.recording, *reader);
    return reader;
  };
  run.progress = [&](std::size_t done) { bar->update(done); };
  run.onRestart = [&](const mba_vo::OfflineResult& result) {
    bar.reset();
    printLearnt(result);
  };
  run.onReturn = [&] {
    bar.reset();
    std::cout << "with that fewer than half as many images have a pose: beginning anew without it" << std::endl;
  };
  return mba_vo::runCalibrated(run, options);
}

std::optional<mba_vo::Machine> machineOf(const Arguments& a) {
  if (!a.live) return std::nullopt;
  mba_vo::Machine machine;
  if (!a.machine_file.empty()) mba_vo::loadYaml(a.machine_file, machine);
  return machine.slowedBy(a.slower);
}

void saveMap(const mba_vo::OfflineResult& result, const std::string& file) {
  if (!result.map) throw std::runtime_error(file + ": not written: there is no map at the end of the run");
  mba_vo::writeMap(file, *result.map);
  std::cout << file << ": " << result.map->keyframes.size() << " keyframes\n";
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
  if (a.recording.sequence.empty() || a.output.empty()) {
    throw std::runtime_error("SEQUENCE and --output are needed; see --help");
  }
  options.config.mapper.deterministic = a.deterministic || a.live;
  options.config.mapper.localize_only = options.config.mapper.localize_only || a.localize_only;
  if (!a.map_file.empty()) options.map = std::make_shared<mba_vo::SavedMap>(mba_vo::readMap(a.map_file));
  options.keep_map = !a.save_map_file.empty();
  options.live = machineOf(a);
  options.exposure = exposureOverride(a.recording);
  options.skip = a.recording.skip;
  options.frames = a.recording.frames;
  options.reference_delay_frames = a.reference_delay;
  if (a.recording.row_time) options.config.image.row_time = *a.recording.row_time;
  adoptWhatIsKnown(a.recording, options.config.image, std::cout);
  mba_vo::CameraMemory memory(options.config.image);
  options.known = memory.recall(openSequence(a.recording)->calibration());
  std::vector<mba_vo::FaultRecord> faults;
  const mba_vo::OfflineResult result = runOver(a, options, faults);
  mba_vo::writeRun(a.output, result, settingsOf(a));
  if (!a.faults.empty()) {
    const std::string file = (std::filesystem::path(a.output) / "faults.csv").string();
    mba_vo::writeFile(file, [&](std::ostream& out) { mba_vo::writeFaults(faults, out); });
  }
  if (!a.save_map_file.empty()) saveMap(result, a.save_map_file);
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
