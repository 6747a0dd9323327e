#include "mba_vo/datasets/dataset.h"

#include <stdexcept>

#include "forms.h"
#include "mba_vo/io/image_files.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

/// This project's own, or TUM-mono, which differs in that camera.txt tells the lens and in what else is known of it.
Dataset openOwnFolder(const fs::path& folder, const DatasetOptions& options) {
  Dataset dataset;
  dataset.form = "sequence folder";
  dataset.reader =
      openSequenceFolder(folder.string(), options.images, options.depth, options.calibration_file, options.camera);
  if (fs::path(cameraFileIn(folder.string())).filename() != "camera.txt") return dataset;
  dataset.form = "TUM-mono";
  if (fs::exists(folder / "pcalib.txt")) dataset.response_file = (folder / "pcalib.txt").string();
  if (fs::exists(folder / "vignette.png")) dataset.vignette_file = (folder / "vignette.png").string();
  dataset.notes.emplace_back(dataset.response_file.empty() ? "no pcalib.txt: grey values are taken for linear light"
                                                           : "response by pcalib.txt");
  if (dataset.vignette_file.empty()) dataset.notes.emplace_back("no vignette.png: dark corners are found on the way");
  return dataset;
}

/// What lies in a folder that is none of a recording, but holds some.
std::string insideHint(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const bool one = entry.is_directory() && (isRgbdFolder(entry.path()) || findAslFolders(entry.path(), "") ||
                                              !sevenScenesFiles(entry.path(), ".color").empty());
    if (one) return "; " + entry.path().string() + " is one";
  }
  return "";
}

}  // namespace

void Dataset::configure(FrameBuilderConfig& config) const {
  if (config.response_file.empty() && config.gamma == 1.0) config.response_file = response_file;
  if (config.vignette_file.empty()) config.vignette_file = vignette_file;
}

void refuseImages(const DatasetOptions& options, const std::string& form) {
  if (options.images == DatasetOptions().images) return;
  throw std::runtime_error("--images " + options.images + ": only sequence folders have such, not those of " + form);
}

void refuseDepth(const DatasetOptions& options, const std::string& form, const std::string& reason) {
  if (options.depth.subfolder.empty()) return;
  throw std::runtime_error("--depth " + options.depth.subfolder + ": " + form + " " + reason);
}

void refuseCamera(const DatasetOptions& options, const std::string& form) {
  if (options.camera.empty()) return;
  throw std::runtime_error("--camera " + options.camera + ": " + form +
                           " has one camera; it can only choose from a --calibration of several, which is not told");
}

cv::Size sizeOfFirst(const std::vector<ListedImage>& images) {
  for (const ListedImage& listed : images) {
    const cv::Mat image = readImage(listed.file);
    if (!image.empty()) return image.size();
  }
  throw std::runtime_error(images.empty() ? "no image"
                                          : images.front().file.string() + ": not a readable image, nor any other");
}

bool isSequenceFolder(const std::string& folder, const std::string& images) {
  const fs::path path(folder);
  requireFolder(path);
  if (isRgbdFolder(path) || findAslFolders(path, "") || !sevenScenesFiles(path, ".color").empty()) return false;
  return fs::exists(path / "times.txt") || fs::exists(path / "camera.yaml") || fs::exists(path / "camera.txt") ||
         fs::is_directory(path / images);
}

Dataset openDataset(const std::string& folder, const DatasetOptions& options) {
  const fs::path path = fs::path(folder).has_filename() ? fs::path(folder) : fs::path(folder).parent_path();
  requireFolder(path);
  if (isRgbdFolder(path)) return openRgbdFolder(path, options);
  if (const auto asl = findAslFolders(path, options.camera)) return openAslFolder(*asl, options);
  if (!sevenScenesFiles(path, ".color").empty()) return openSevenScenesFolder(path, options);
  if (isSequenceFolder(path.string(), options.images)) return openOwnFolder(path, options);
  throw std::runtime_error(
      folder +
      ": no recording that is known: images and times.txt (sequence folder, TUM-mono), rgb.txt (TUM "
      "RGB-D, ETH3D), mav0/cam0/data.csv (EuRoC, TUM-VI) or frame-000000.color.png (7-Scenes)" +
      insideHint(path));
}

}  // namespace mba_vo
