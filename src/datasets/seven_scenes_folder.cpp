#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "forms.h"
#include "mba_vo/io/text_lines.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

/// Nobody calibrated the colour camera; this is what a Kinect has by its makers, to some per cent.
const CameraCalibration kKinectDefault{640, 480, 525.0, 525.0, 319.5, 239.5, "", {}};

}  // namespace

std::vector<NumberedFile> sevenScenesFiles(const fs::path& folder, const std::string& kind) {
  const std::string prefix = "frame-";
  std::vector<NumberedFile> files;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(folder, fs::directory_options::skip_permission_denied)) {
    const std::string name = entry.path().stem().string();  // frame-000000.color
    if (name.compare(0, prefix.size(), prefix) != 0 || fs::path(name).extension() != kind) continue;
    const std::string number = fs::path(name).stem().string().substr(prefix.size());
    files.push_back({parseWhole(number, "number of the frame", entry.path().string()), entry.path()});
  }
  std::sort(files.begin(), files.end(), [](const NumberedFile& a, const NumberedFile& b) { return a.file < b.file; });
  return files;
}

std::int64_t sevenScenesTime(std::uint64_t number) {
  return std::llround(1e9 * static_cast<double>(number) / kSevenScenesRate);
}

Dataset openSevenScenesFolder(const fs::path& folder, const DatasetOptions& options) {
  Dataset dataset;
  dataset.form = "7-Scenes";
  refuseImages(options, dataset.form);
  refuseDepth(options, dataset.form, "has depth images of another camera, not of the pixels of the images");
  ImageList list;
  for (NumberedFile& image : sevenScenesFiles(folder, ".color")) {
    list.images.push_back({sevenScenesTime(image.number), std::nullopt, std::move(image.file)});
  }
  const fs::path own = cameraFileIn(folder.string());
  const fs::path file =
      !options.calibration_file.empty() || !fs::exists(own) ? fs::path(options.calibration_file) : own;
  if (file.empty()) {
    refuseCamera(options, dataset.form);
    list.calibration = kKinectDefault;
    list.calibration_name = "the default of a Kinect";
    dataset.notes.emplace_back(
        "no calibration is published: 525 px and the middle of the image are assumed, wrong by some per cent; "
        "--calibration if you have one");
  } else {
    list.calibration = readChosenCamera(file.string(), options.camera, sizeOfFirst(list.images)).calibration;
    list.calibration_name = file.filename().string();
  }
  dataset.notes.emplace_back(
      "no stamps: 30 Hz are assumed; rolling shutter, exposure automatic and unknown: both are estimated");
  dataset.reader = readListed(std::move(list));
  return dataset;
}

}  // namespace mba_vo
