#include "mba_vo/inspection/folder_inspection.h"

#include <cctype>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <vector>

#include "mba_vo/inspection/camera_inspection.h"
#include "mba_vo/inspection/judgements.h"
#include "mba_vo/io/camera_file.h"
#include "mba_vo/io/image_files.h"
#include "mba_vo/io/times_file.h"
#include "wording.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolderOfExposures = "images";     // times.txt speaks of these images
constexpr std::int64_t kAssumedIntervalNs = 33'333'333;  // where times.txt cannot be read

class FolderInspection {
 public:
  FolderInspection(fs::path folder, std::string subfolder)
      : folder_(std::move(folder)), subfolder_(std::move(subfolder)) {
    report_.path = folder_.string();
  }

  InspectionReport run(const InspectionProgress& progress) {
    findImages();
    if (files_.empty()) {
      report_.readable = false;
      report_.findings.push_back(
          {Check::kNoImages, (folder_ / subfolder_).string() + " has no images with a number as name"});
      return report_;
    }
    readCalibration();
    readTimes();
    lookAtImages(progress);
    CameraReport camera;
    camera.source.name = (folder_ / subfolder_).string();
    camera.source.images_subfolder = subfolder_;
    camera.facts = camera_.facts();
    camera.findings = judge(camera.facts);
    report_.cameras.push_back(std::move(camera));
    return report_;
  }

 private:
  void say(Check check, const std::string& what) { report_.findings.push_back({check, what}); }

  void findImages() {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / subfolder_, error)) {
      const std::string name = entry.path().stem().string();
      constexpr std::size_t kMostDigits = 18;
      if (!isImageName(entry.path()) || name.empty() || name.size() > kMostDigits) continue;
      if (name.find_first_not_of("0123456789") == std::string::npos) files_[std::stoull(name)] = entry.path();
    }
    report_.contents.push_back(subfolder_ + ": " + std::to_string(files_.size()) + " images");
  }

  void readCalibration() {
    const std::string file = (folder_ / "camera.yaml").string();
    if (!fs::exists(file)) {
      say(Check::kNoCameraInfo, "there is no " + file);
      return;
    }
    try {
      camera_.setCalibration(readCameraFile(file).calibration);
    } catch (const std::runtime_error& error) {
      say(Check::kBadCameraInfo, error.what());
    }
  }

  void readTimes() {
    try {
      times_ = readTimesFile((folder_ / "times.txt").string());
    } catch (const std::runtime_error& error) {
      say(Check::kBadTimes, std::string(error.what()) + "; 30 Hz are assumed in what follows");
      for (const auto& file : files_) {
        const auto i = static_cast<std::int64_t>(times_.size());
        times_.push_back({file.first, (i + 1) * kAssumedIntervalNs, std::nullopt});
      }
      return;
    }
    report_.contents.push_back("times.txt: " + std::to_string(times_.size()) + " images");
    std::size_t missing = 0;
    std::uint64_t first = 0;
    for (const ImageTime& time : times_) {
      if (files_.count(time.id) == 0 && missing++ == 0) first = time.id;
    }
    if (missing > 0) {
      say(Check::kMissingImages,
          countOf(missing, times_.size()) + " of times.txt do not exist, the first is number " + std::to_string(first));
    }
  }

  void lookAtImages(const InspectionProgress& progress) {
    std::size_t done = 0;
    for (const ImageTime& time : times_) {
      progress(++done, times_.size());
      const auto file = files_.find(time.id);
      if (file == files_.end()) continue;
      SeenImage seen;
      seen.stamp_ns = time.mid_exposure_ns;
      seen.image = readImage(file->second);
      const std::string extension = file->second.extension().string();
      seen.encoding = extension.substr(1) + (seen.image.empty() ? "" : " " + cv::typeToString(seen.image.type()));
      if (seen.image.empty()) seen.problem = file->second.string() + ": not a readable image";
      if (extension == ".jpg" || extension == ".jpeg") camera_.setJpeg();
      camera_.add(seen);
      if (subfolder_ == kFolderOfExposures && time.exposure) camera_.addExposure(seen.stamp_ns, *time.exposure);
    }
  }

  fs::path folder_;
  std::string subfolder_;
  std::map<std::uint64_t, fs::path> files_;  // by number
  std::vector<ImageTime> times_;
  CameraInspection camera_;
  InspectionReport report_;
};

}  // namespace

InspectionReport inspectFolder(const std::string& folder, const std::string& images_subfolder,
                               const InspectionProgress& progress) {
  return FolderInspection(folder, images_subfolder).run(progress);
}

}  // namespace mba_vo
