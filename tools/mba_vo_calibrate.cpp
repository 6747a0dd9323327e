// Learns the calibration of a camera from a recording, a folder or a bag, without any target. Needs no ROS master.
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>

#include "mba_vo/io/calibration_report.h"
#include "mba_vo/odometry/config_yaml.h"
#include "plot.h"
#include "recording.h"

namespace {

struct Arguments {
  RecordingArguments recording;
  std::string output;
  std::string config_file;
  int passes = 6;
};

void describe(CLI::App& app, Arguments& a) {
  describeRecording(app, a.recording);
  app.add_option("--output", a.output, "folder for the results, made if need be");
  app.add_option("--config", a.config_file, "YAML file with options; see mba_vo_offline --print-config");
  app.add_option("--passes", a.passes, "most passes over the recording")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
}

mba_vo::OfflineOptions optionsOf(const Arguments& a) {
  mba_vo::OfflineOptions options;
  if (!a.config_file.empty()) options.config = mba_vo::loadConfig(a.config_file);
  mba_vo::finalize(options.config);
  options.config.mapper.deterministic = true;
  options.exposure = exposureOverride(a.recording);
  options.skip = a.recording.skip;
  options.frames = a.recording.frames;
  if (a.recording.row_time) options.config.image.row_time = *a.recording.row_time;
  return options;
}

void run(const Arguments& a) {
  if (a.recording.sequence.empty() || a.output.empty()) {
    throw std::runtime_error("SEQUENCE and --output are needed; see --help");
  }
  mba_vo::OfflineOptions options = optionsOf(a);
  adoptWhatIsKnown(a.recording, options.config.image, std::cout);
  const mba_vo::ToldCamera told{openSequence(a.recording)->calibration(), options.config.image};
  std::unique_ptr<mba_vo::ProgressBar> bar;
  mba_vo::CalibratedRun passes;
  passes.open = [&] {
    auto reader = openSequence(a.recording);
    bar = progressBar(a.recording, *reader);
    return reader;
  };
  passes.progress = [&](std::size_t done) { bar->update(done); };
  passes.onRestart = [&](const mba_vo::OfflineResult&) { bar.reset(); };
  const mba_vo::CalibrationStudy study = mba_vo::studyCalibration(passes, options, a.passes);
  mba_vo::printCalibration(told, study, std::cout);
  mba_vo::writeCalibration(a.output, told, study);
  plotCalibration((std::filesystem::path(a.output) / "calibration.png").string(), told, study);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Learns the calibration of a camera from a recording.", "mba_vo_calibrate");
  Arguments arguments;
  describe(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "mba_vo_calibrate: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
