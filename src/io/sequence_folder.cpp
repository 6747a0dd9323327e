#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iomanip>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "mba_vo/io/camera_file.h"
#include "mba_vo/io/image_files.h"
#include "mba_vo/io/listed_sequence.h"
#include "mba_vo/io/times_file.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolderOfExposures = "images";  // times.txt speaks of these images

/// The number that is the whole name, whatever its leading zeros.
std::optional<std::uint64_t> idOf(const std::string& name) {
  constexpr std::size_t kMostDigits = 19;
  const bool digits =
      !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  if (!digits || name.size() > kMostDigits) return std::nullopt;
  return std::stoull(name);
}

std::map<std::uint64_t, fs::path> imagesById(const fs::path& folder) {
  std::map<std::uint64_t, fs::path> images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const auto id = isImageName(entry.path()) ? idOf(entry.path().stem().string()) : std::nullopt;
    if (!id) continue;
    const auto found = images.emplace(*id, entry.path()).first;
    found->second = std::min(found->second, entry.path());  // the same, whatever the order on the disk
  }
  return images;
}

std::string nameOfImage(std::uint64_t id) {
  constexpr int kDigits = 6;
  std::ostringstream name;
  name << std::setw(kDigits) << std::setfill('0') << id;
  return name.str();
}

void findDepths(const fs::path& folder, const std::vector<ImageTime>& times, ImageList& list) {
  requireFolder(folder);
  const std::map<std::uint64_t, fs::path> images = imagesById(folder);
  bool any = false;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto found = images.find(times[i].id);
    if (found == images.end()) continue;
    list.images[i].depth = found->second;
    any = true;
  }
  if (!any) {
    throw std::runtime_error(folder.string() + ": no depth image of any image that times.txt lists, e.g. " +
                             nameOfImage(times.front().id) + ".png");
  }
}

}  // namespace

std::unique_ptr<SequenceReader> openSequenceFolder(const std::string& folder, const std::string& images_subfolder,
                                                   const DepthFolder& depth, const std::string& camera_file,
                                                   const std::string& camera) {
  const fs::path path(folder);
  const fs::path images_folder = path / images_subfolder;
  requireFolder(path);
  requireFolder(images_folder);
  const fs::path file = camera_file.empty() ? cameraFileIn(folder) : camera_file;
  ImageList list{
      readChosenCamera(file.string(), camera).calibration, file.filename().string(), {}, depth.units_per_metre};
  const std::vector<ImageTime> times = readTimesFile((path / "times.txt").string());
  const std::map<std::uint64_t, fs::path> images = imagesById(images_folder);
  for (const ImageTime& time : times) {
    const auto found = images.find(time.id);
    if (found == images.end()) {
      throw std::runtime_error((images_folder / nameOfImage(time.id)).string() +
                               ".*: no such image, though times.txt lists it");
    }
    const bool exposed = images_subfolder == kFolderOfExposures;
    list.images.push_back({time.mid_exposure_ns, exposed ? time.exposure : std::nullopt, found->second});
  }
  if (!depth.subfolder.empty()) findDepths(path / depth.subfolder, times, list);
  return readListed(std::move(list));
}

}  // namespace mba_vo
