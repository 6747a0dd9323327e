#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "forms.h"
#include "mba_vo/io/text_lines.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kDepthTolerance = 20'000'000;  // [ns] as TUM's own tool pairs images

/// A Kinect that TUM recorded with.
struct Kinect {
  std::array<const char*, 2> names;  // in the name of the recording
  CameraCalibration calibration;     // of its colour camera, as published with the data set
};

std::vector<Kinect> kinects() {
  return {{{"freiburg1", "fr1"},
           {640,
            480,
            517.306408,
            516.469215,
            318.643040,
            255.313989,
            "plumb_bob",
            {0.262383, -0.953104, -0.005358, 0.002628, 1.163314}}},
          {{"freiburg2", "fr2"},
           {640,
            480,
            520.908620,
            521.007327,
            325.141442,
            249.701764,
            "plumb_bob",
            {0.231222, -0.784899, -0.003257, -0.000105, 0.917205}}},
          {{"freiburg3", "fr3"}, {640, 480, 535.4, 539.2, 320.1, 247.6, "", {}}}};
}

struct StampedFile {
  std::int64_t stamp_ns;
  fs::path file;
  std::string where;
};

/// rgb.txt or depth.txt: `stamp file`.
std::vector<StampedFile> readList(const fs::path& list) {
  std::vector<StampedFile> files;
  for (const TextLine& line : splitLines(readText(list.string()), list.string())) {
    if (line.words.size() != 2) {
      throw std::runtime_error(line.where + ": " + std::to_string(line.words.size()) +
                               " columns; 'time[s] file' is allowed");
    }
    const fs::path file = list.parent_path() / line.words[1];
    if (!fs::exists(file)) throw std::runtime_error(line.where + ": " + file.string() + ": no such image");
    files.push_back({parseSeconds(line.words[0], line.where), file, line.where});
  }
  if (files.empty()) throw std::runtime_error(list.string() + ": lists no image");
  return files;
}

/// The Kinect by what the folder or, in its comments, rgb.txt calls the recording.
std::optional<Kinect> kinectOf(const fs::path& folder) {
  std::string comments;
  std::istringstream text(readText((folder / "rgb.txt").string()));
  for (std::string line; std::getline(text, line);) {
    if (line.compare(0, 1, "#") == 0) comments += line + "\n";
  }
  for (const std::string& name : {fs::absolute(folder).filename().string(), comments}) {
    for (const Kinect& kinect : kinects()) {
      for (const char* part : kinect.names) {
        if (name.find(part) != std::string::npos) return kinect;
      }
    }
  }
  return std::nullopt;
}

/// The calibration that was named or lies in the folder; nullopt if neither.
std::optional<fs::path> calibrationFile(const fs::path& folder, const DatasetOptions& options) {
  if (!options.calibration_file.empty()) return options.calibration_file;
  for (const fs::path& file : {folder / "calibration.txt", fs::path(cameraFileIn(folder.string()))}) {
    if (fs::exists(file)) return file;
  }
  return std::nullopt;
}

void calibrate(const fs::path& folder, const DatasetOptions& options, Dataset& dataset, ImageList& list) {
  const auto file = calibrationFile(folder, options);
  const auto kinect = kinectOf(folder);
  if (file) {
    list.calibration = readChosenCamera(file->string(), options.camera, sizeOfFirst(list.images)).calibration;
    list.calibration_name = file->filename().string();
  } else if (kinect) {
    refuseCamera(options, "TUM RGB-D");
    list.calibration = kinect->calibration;
    list.calibration_name = std::string("that of TUM's ") + kinect->names[0];
    dataset.notes.push_back("calibration as published for " + std::string(kinect->names[0]));
  } else {
    throw std::runtime_error(
        folder.string() +
        ": no calibration: there is no calibration.txt (ETH3D) or camera.yaml, and the name of the "
        "folder has none of freiburg1, freiburg2, freiburg3 (TUM RGB-D); name it with --calibration");
  }
  const bool eth3d = file && file->filename() == "calibration.txt";
  dataset.form = eth3d ? "ETH3D SLAM" : "TUM RGB-D";
  dataset.notes.emplace_back(
      eth3d ? "global shutter; exposure unknown: it is estimated"
            : "rolling shutter, exposure automatic and unknown: both are estimated; --row-time if you know");
}

void addDepths(const fs::path& folder, ImageList& list) {
  std::vector<StampedFile> depths = readList(folder / "depth.txt");
  std::sort(depths.begin(), depths.end(),
            [](const StampedFile& a, const StampedFile& b) { return a.stamp_ns < b.stamp_ns; });
  for (ListedImage& image : list.images) {
    auto after = std::lower_bound(depths.begin(), depths.end(), image.mid_exposure_ns,
                                  [](const StampedFile& d, std::int64_t t) { return d.stamp_ns < t; });
    const auto distance = [&](auto d) { return std::llabs(d->stamp_ns - image.mid_exposure_ns); };
    if (after == depths.end() || (after != depths.begin() && distance(after - 1) < distance(after))) --after;
    if (distance(after) <= kDepthTolerance) image.depth = after->file;
  }
}

}  // namespace

bool isRgbdFolder(const fs::path& folder) { return fs::exists(folder / "rgb.txt"); }

Dataset openRgbdFolder(const fs::path& folder, const DatasetOptions& options) {
  Dataset dataset;
  refuseImages(options, "TUM RGB-D and ETH3D");
  ImageList list;
  list.depth_units = options.depth.units_per_metre;
  for (StampedFile& image : readList(folder / "rgb.txt")) {
    list.images.push_back({image.stamp_ns, std::nullopt, std::move(image.file)});
  }
  calibrate(folder, options, dataset, list);
  if (!options.depth.subfolder.empty()) {
    requireFolder(folder / options.depth.subfolder);
    addDepths(folder, list);
  }
  dataset.reader = readListed(std::move(list));
  return dataset;
}

}  // namespace mba_vo
