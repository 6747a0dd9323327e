#include "mba_vo/inspection/folder_inspection.h"

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

/// What the form of the recording tells of the camera.
void adopt(const Dataset& dataset, InspectionReport& report, CameraInspection& camera) {
  report.contents.push_back("form: " + dataset.form);
  for (const std::string& note : dataset.notes) report.contents.push_back(note);
  if (!dataset.response_file.empty()) camera.setResponseKnown();
}

CameraReport reportOn(const CameraInspection& camera, RecordedCamera source) {
  CameraReport report;
  report.source = std::move(source);
  report.facts = camera.facts();
  report.findings = judge(report.facts);
  return report;
}

/// Of a sequence folder, whatever is wrong with it.
class FolderInspection {
 public:
  FolderInspection(fs::path folder, const DatasetOptions& options)
      : folder_(std::move(folder)), subfolder_(options.images), options_(options) {
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
    readForm();
    readCalibration();
    readTimes();
    lookAtImages(progress);
    RecordedCamera source;
    source.name = (folder_ / subfolder_).string();
    source.images_subfolder = subfolder_;
    source.camera = options_.camera;
    source.calibration_file = options_.calibration_file;
    report_.cameras.push_back(reportOn(camera_, std::move(source)));
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

  void readForm() {
    try {
      adopt(openDataset(folder_.string(), options_), report_, camera_);
    } catch (const std::runtime_error&) {
      return;  // what is wrong is found in what follows
    }
  }

  void readCalibration() {
    const std::string& told = options_.calibration_file;
    const std::string file = told.empty() ? cameraFileIn(folder_.string()) : told;
    if (!fs::exists(file)) {
      say(Check::kNoCameraInfo, "there is no " + file);
      return;
    }
    try {
      camera_.setCalibration(readChosenCamera(file, options_.camera).calibration);
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
  DatasetOptions options_;
  std::map<std::uint64_t, fs::path> files_;  // by number
  std::vector<ImageTime> times_;
  CameraInspection camera_;
  InspectionReport report_;
};

void look(const Dataset& dataset, const InspectionProgress& progress, CameraInspection& camera) {
  camera.setCalibration(dataset.reader->calibration());
  std::size_t done = 0;
  while (const std::optional<CameraImage> image = dataset.reader->next()) {
    progress(++done, dataset.reader->size());
    SeenImage seen;
    seen.stamp_ns = image->stamp_ns;
    seen.image = image->image;
    seen.encoding = image->image.empty() ? "unreadable" : cv::typeToString(image->image.type());
    seen.problem = image->problem;
    camera.add(seen);
    if (image->exposure) camera.addExposure(image->stamp_ns, *image->exposure);
  }
}

/// Of any other form, whose readers end with the first thing that is missing or malformed.
InspectionReport inspectDataset(const std::string& folder, const DatasetOptions& options,
                                const InspectionProgress& progress) {
  InspectionReport report;
  report.path = folder;
  CameraInspection camera;
  try {
    const Dataset dataset = openDataset(folder, options);
    adopt(dataset, report, camera);
    look(dataset, progress, camera);
  } catch (const std::runtime_error& error) {
    report.findings.push_back({Check::kBadFolder, error.what()});
  }
  report.readable = !camera.facts().images.empty();
  if (!report.readable) return report;
  RecordedCamera source;
  source.name = folder + (options.camera.empty() ? "" : ", " + options.camera);
  source.camera = options.camera;
  source.calibration_file = options.calibration_file;
  report.cameras.push_back(reportOn(camera, std::move(source)));
  return report;
}

}  // namespace

InspectionReport inspectFolder(const std::string& folder, const DatasetOptions& options,
                               const InspectionProgress& progress) {
  if (isSequenceFolder(folder, options.images)) return FolderInspection(folder, options).run(progress);
  return inspectDataset(folder, options, progress);
}

}  // namespace mba_vo
