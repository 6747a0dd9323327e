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
  app.add_option("--camera", a.folder.camera, "which of several cameras of a folder: cam0, cam1, ...");
  app.add_option("--calibration", a.folder.calibration_file, "of the camera, in place of that of the folder")
      ->check(CLI::ExistingFile);
  app.add_option("--image-topic", a.image_topic, "look at this topic of the bag only");
}

mba_vo::InspectionReport inspectBag(const Arguments& a, const mba_vo::InspectionProgress& progress) {
#ifdef MBA_VO_WITH_ROS
  return mba_vo::inspectBag(a.recording, a.image_topic, progress);
#else
  static_cast<void>(progress);
  throw std::runtime_error(a.recording + ": this program was built without ROS (MBA_VO_ROS=OFF) and cannot read bags");
#endif
}

int check(Arguments a) {
  if (!std::filesystem::exists(a.recording)) {
    throw std::runtime_error(a.recording + ": no such folder or bag");
  }
  a.recording = std::filesystem::absolute(a.recording).lexically_normal().string();
  std::unique_ptr<mba_vo::ProgressBar> bar;
  const mba_vo::InspectionProgress progress = [&bar](std::size_t done, std::size_t all) {
    if (!bar) bar = std::make_unique<mba_vo::ProgressBar>(std::cerr, all, isatty(STDERR_FILENO) != 0);
    bar->update(done);
  };
  const mba_vo::InspectionReport report = std::filesystem::is_directory(a.recording)
                                              ? mba_vo::inspectFolder(a.recording, a.folder, progress)
                                              : inspectBag(a, progress);
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
