// Writes a recording, a folder or a bag, in the forms that other systems read, so that they can be compared on it:
// images, lists with times and exposures, calibration and true trajectory. Needs no ROS master.
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "mba_vo/datasets/ground_truth.h"
#include "mba_vo/datasets/sequence_export.h"
#include "mba_vo/odometry/config_yaml.h"
#include "recording.h"

namespace {

namespace fs = std::filesystem;

struct Arguments {
  RecordingArguments recording;
  std::string output;
  std::string config_file;
  std::string groundtruth;
  mba_vo::ExportOptions options;
};

void describe(CLI::App& app, Arguments& a) {
  describeRecording(app, a.recording);
  app.add_option("--output", a.output, "folder to write, made if need be; each form is a folder in it");
  app.add_option("--config", a.config_file, "YAML file with options: gamma, response, vignette, white level");
  app.add_option("--groundtruth", a.groundtruth,
                 "true trajectory, file or folder; default: that of the recording, if it has one");
  app.add_option("--form", a.options.forms, "dso, euroc (ORB-SLAM), tum (ORB-SLAM)")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::IsMember(mba_vo::exportForms()));
  app.add_flag("--rectify", a.options.rectify, "images of an ideal pinhole camera, for lenses that others do not know");
  app.add_flag("--overwrite", a.options.overwrite, "replace an earlier export");
}

std::vector<mba_vo::PoseRecord> readTruth(const Arguments& a) {
  const mba_vo::GroundTruthOptions options{a.recording.calibration, a.recording.camera};
  if (!a.groundtruth.empty()) return mba_vo::readGroundTruth(a.groundtruth, options);
  if (!fs::is_directory(a.recording.sequence) || !mba_vo::hasGroundTruth(a.recording.sequence)) return {};
  return mba_vo::readGroundTruth(a.recording.sequence, options);
}

/// What only this project's sequences have: poses at start and end of each exposure, and the length of the blur.
void copyOwnFiles(const Arguments& a, bool all_images) {
  for (const char* name : {"groundtruth_exposure.txt", "blur_px.txt"}) {
    const fs::path file = fs::path(a.recording.sequence) / name;
    const bool by_line = std::string(name) == "blur_px.txt";  // one for each image, without a time
    if (!fs::is_regular_file(file) || (by_line && !all_images)) continue;
    for (const std::string& form : a.options.forms) {
      fs::copy_file(file, fs::path(a.output) / form / name, fs::copy_options::overwrite_existing);
    }
  }
}

void refuseWhatMakesNoSense(const Arguments& a) {
  if (a.recording.sequence.empty() || a.output.empty()) {
    throw std::runtime_error("SEQUENCE and --output are needed; see --help");
  }
  if (a.recording.row_time) throw std::runtime_error("--row-time: none of the forms has a place for it");
}

void run(const Arguments& a) {
  refuseWhatMakesNoSense(a);
  mba_vo::OdometryConfig config;
  if (!a.config_file.empty()) config = mba_vo::loadConfig(a.config_file);
  mba_vo::finalize(config);
  const auto reader = openSequence(a.recording);
  adoptWhatIsKnown(a.recording, config.image, std::cout);
  const std::vector<mba_vo::PoseRecord> truth = readTruth(a);
  mba_vo::SequenceExport exported(a.output, reader->calibration(), config.image, a.options);
  const std::optional<double> exposure = exposureOverride(a.recording);
  {
    const std::unique_ptr<mba_vo::ProgressBar> bar = progressBar(a.recording, *reader);
    for (std::size_t i = 0; i < a.recording.skip && reader->skip(); ++i) continue;
    for (std::size_t i = 0; a.recording.frames == 0 || i < a.recording.frames; ++i) {
      auto image = reader->next();
      if (!image) break;
      if (exposure) image->exposure = exposure;
      exported.add(*image);
      bar->update(a.recording.skip + i + 1);
    }
  }
  exported.finish(truth);
  copyOwnFiles(a, exported.frames().size() == reader->size());
  for (const std::string& reason : exported.leftOut()) std::cout << "left out: " << reason << "\n";
  std::cout << exported.frames().size() << " images, " << truth.size() << " true poses: " << a.output << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  try {
    CLI::App app("Writes a recording in the forms that DSO, ORB-SLAM and readers of EuRoC or TUM RGB-D take.",
                 "mba_vo_export");
    Arguments arguments;
    describe(app, arguments);
    CLI11_PARSE(app, argc, argv);
    run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "mba_vo_export: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
