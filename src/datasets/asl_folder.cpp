#include <map>
#include <stdexcept>
#include <utility>

#include "forms.h"
#include "mba_vo/io/text_lines.h"
#include "mba_vo/io/times_file.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFirstCamera = "cam0";

/// What TUM-VI adds to the layout.
fs::path dsoFolder(const AslFolders& folders) { return folders.root / "dso" / folders.camera.filename(); }

std::vector<ListedImage> readImages(const fs::path& camera) {
  const fs::path list = camera / "data.csv";
  const fs::path images = camera / "data";
  requireFolder(images);
  std::vector<ListedImage> result;
  for (const TextLine& line : splitLines(readText(list.string()), list.string(), ", \t\r")) {
    if (line.words.size() != 2) {
      throw std::runtime_error(line.where + ": " + std::to_string(line.words.size()) +
                               " columns; 'time[ns],file' is allowed");
    }
    const fs::path file = images / line.words[1];
    if (!fs::exists(file)) throw std::runtime_error(line.where + ": " + file.string() + ": no such image");
    result.push_back({parseNanoseconds(line.words[0], line.where), std::nullopt, file});
  }
  if (result.empty()) throw std::runtime_error(list.string() + ": lists no image");
  return result;
}

/// Exposures by the stamps of the images, as which dso/cam0/times.txt has its ids.
std::size_t addExposures(const fs::path& times_file, std::vector<ListedImage>& images) {
  std::map<std::int64_t, std::optional<double>> exposures;
  for (const ImageTime& time : readTimesFile(times_file.string())) {
    exposures[static_cast<std::int64_t>(time.id)] = time.exposure;
  }
  std::size_t found = 0;
  for (ListedImage& image : images) {
    const auto exposure = exposures.find(image.mid_exposure_ns);
    if (exposure == exposures.end()) continue;
    image.exposure = exposure->second;
    ++found;
  }
  return found;
}

void addWhatTumViTells(const fs::path& dso, Dataset& dataset, ImageList& list) {
  const fs::path times = dso / "times.txt";
  if (fs::exists(times)) {
    const std::size_t found = addExposures(times, list.images);
    if (found == 0) {
      throw std::runtime_error(times.string() + ": its ids are the stamps of no image of data.csv, e.g. " +
                               std::to_string(list.images.front().mid_exposure_ns));
    }
    dataset.notes.push_back("global shutter; exposures of " + std::to_string(found) + " of " +
                            std::to_string(list.images.size()) + " images by " + times.string());
  }
  if (fs::exists(dso / "pcalib.txt")) dataset.response_file = (dso / "pcalib.txt").string();
  if (fs::exists(dso / "vignette.png")) dataset.vignette_file = (dso / "vignette.png").string();
}

/// `folder` as one of a camera, if it is.
std::optional<AslFolders> asCamera(const fs::path& folder) {
  if (!fs::exists(folder / "data.csv") || !fs::is_directory(folder / "data")) return std::nullopt;
  const fs::path camera = fs::weakly_canonical(folder);
  return AslFolders{camera.parent_path().parent_path(), camera};
}

}  // namespace

std::optional<AslFolders> findAslFolders(const fs::path& folder, const std::string& camera) {
  if (auto itself = asCamera(folder)) return itself;
  for (const fs::path& mav : {folder / "mav0", folder}) {
    const bool is_mav = mav == folder ? folder.filename() == "mav0" : fs::is_directory(mav);
    if (!is_mav) continue;
    const fs::path path = mav / (camera.empty() ? kFirstCamera : camera);
    requireFolder(path);
    return AslFolders{mav.parent_path(), path};
  }
  return std::nullopt;
}

fs::path aslCameraFile(const AslFolders& folders) {
  std::string tried;
  for (const fs::path& file : {folders.camera / "sensor.yaml", folders.root / "dso" / "camchain.yaml",
                               folders.root / "camchain.yaml", dsoFolder(folders) / "camera.txt"}) {
    if (fs::exists(file)) return file;
    tried += (tried.empty() ? "" : ", ") + file.string();
  }
  throw std::runtime_error(folders.camera.string() + ": no calibration, none of " + tried +
                           "; name it with --calibration");
}

Dataset openAslFolder(const AslFolders& folders, const DatasetOptions& options) {
  Dataset dataset;
  refuseImages(options, "EuRoC and TUM-VI");
  refuseDepth(options, "EuRoC and TUM-VI", "have no depth images");
  ImageList list;
  list.images = readImages(folders.camera);
  const fs::path file = options.calibration_file.empty() ? aslCameraFile(folders) : fs::path(options.calibration_file);
  // A file of the rig has the camera under the name of its folder, but one of a single camera may call it anything.
  const std::string own_name = folders.camera.filename().string();
  const bool of_another = !options.camera.empty() && options.camera != own_name;  // it chooses from the file alone
  list.calibration = of_another ? readChosenCamera(file.string(), options.camera).calibration
                                : readCameraFile(file.string(), own_name).calibration;
  list.calibration_name = file.filename().string();
  const fs::path dso = dsoFolder(folders);
  dataset.form = fs::is_directory(dso) ? "TUM-VI" : "EuRoC (ASL)";
  addWhatTumViTells(dso, dataset, list);
  if (dataset.notes.empty())
    dataset.notes.emplace_back("global shutter; exposure automatic and unknown: it is estimated");
  dataset.reader = readListed(std::move(list));
  return dataset;
}

}  // namespace mba_vo
