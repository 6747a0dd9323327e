// Looks at a recording before the odometry does: what is in it, what is wrong, and how to run it.
#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>

#include "mba_vo/inspection/folder_inspection.h"
#include "mba_vo/io/progress_bar.h"
#ifdef MBA_VO_WITH_ROS
#include "mba_vo/ros/bag_inspection.h"
#endif

namespace {

constexpr int kUnreadable = 2;

struct Arguments {
  std::string recording;
  mba_vo::DatasetOptions folder;
  std::string image_topic;
};

void describe(CLI::App& app, Arguments& a) {
  app.add_option("RECORDING", a.recording, "folder of a sequence or of a known data set, or .bag file")->required();
  app.add_option("--images", a.folder.images, "sub-folder with the images of a sequence folder")->capture_default_str();
  app.add_option("--camera", a.folder.camera, "which of several cameras of a folder or a calibration: cam0, cam1, ...");
  app.add_option("--calibration", a.folder.calibration_file,
                 "file with the calibration of the camera, in place of the recording's")
      ->check(CLI::ExistingFile);
  app.add_option("--image-topic", a.image_topic, "look at this topic of the bag only");
}

mba_vo::InspectionReport inspectBag(const Arguments& a, const mba_vo::InspectionProgress& progress) {
#ifdef MBA_VO_WITH_ROS
  return mba_vo::inspectBag(a.recording, {a.image_topic, a.folder.calibration_file, a.folder.camera}, progress);
#else
  static_cast<void>(progress);
  throw std::runtime_error(a.recording + ": this program was built without ROS (MBA_VO_ROS=OFF) and cannot read bags");
#endif
}

/// What would have no effect is a mistake.
void refuseWhatMakesNoSense(const Arguments& a, bool is_folder) {
  if (is_folder && !a.image_topic.empty()) {
    throw std::runtime_error("--image-topic " + a.image_topic + ": only bags have topics, not folders");
  }
  if (is_folder) return;
  if (a.folder.images != mba_vo::DatasetOptions().images) {
    throw std::runtime_error("--images " + a.folder.images + ": only folders have such; for a bag, --image-topic");
  }
  if (!a.folder.camera.empty() && a.folder.calibration_file.empty()) {
    throw std::runtime_error("--camera " + a.folder.camera +
                             ": for a bag it chooses from --calibration, which is not told; topics by --image-topic");
  }
}

int check(Arguments a) {
  if (!std::filesystem::exists(a.recording)) {
    throw std::runtime_error(a.recording + ": no such folder or bag");
  }
  const bool is_folder = std::filesystem::is_directory(a.recording);
  refuseWhatMakesNoSense(a, is_folder);
  a.recording = std::filesystem::absolute(a.recording).lexically_normal().string();
  if (!a.folder.calibration_file.empty()) {
    a.folder.calibration_file = std::filesystem::absolute(a.folder.calibration_file).lexically_normal().string();
  }
  std::unique_ptr<mba_vo::ProgressBar> bar;
  const mba_vo::InspectionProgress progress = [&bar](std::size_t done, std::size_t all) {
    if (!bar) bar = std::make_unique<mba_vo::ProgressBar>(std::cerr, all, isatty(STDERR_FILENO) != 0);
    bar->update(done);
  };
  const mba_vo::InspectionReport report =
      is_folder ? mba_vo::inspectFolder(a.recording, a.folder, progress) : inspectBag(a, progress);
  bar.reset();
  mba_vo::print(report, std::cout);
  return mba_vo::exitStatus(report);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Looks at a recording: what is in it, what is wrong, what it costs, and how to run it. Exit status: 0 = nothing "
      "is wrong, 1 = there are problems, 2 = it cannot be read.",
      "mba_vo_check");
  Arguments arguments;
  describe(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    return check(arguments);
  } catch (const std::exception& error) {
    std::cerr << "mba_vo_check: " << error.what() << "\n";
    return kUnreadable;
  }
}
