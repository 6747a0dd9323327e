#include <filesystem>
#include <iomanip>
#include <map>
#include <sstream>
#include <stdexcept>

#include "mba_vo/io/camera_yaml.h"
#include "mba_vo/io/image_file.h"
#include "mba_vo/io/sequence.h"
#include "mba_vo/io/times_file.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolderOfExposures = "images";  // times.txt speaks of these images

/// Name without extension -> file, of every image in `folder`.
std::map<std::string, fs::path> imagesByName(const fs::path& folder) {
  std::map<std::string, fs::path> images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (isImageName(entry.path())) {
      images[entry.path().stem().string()] = entry.path();
    }
  }
  return images;
}

std::string nameOfImage(std::uint64_t id) {
  constexpr int kDigits = 6;
  std::ostringstream name;
  name << std::setw(kDigits) << std::setfill('0') << id;
  return name.str();
}

class SequenceFolder : public SequenceReader {
 public:
  SequenceFolder(const fs::path& folder, const std::string& images_subfolder, const DepthFolder& depth)
      : depth_units_(depth.units_per_metre) {
    requireFolder(folder);
    requireFolder(folder / images_subfolder);
    calibration_ = loadCameraYaml((folder / "camera.yaml").string());
    times_ = readTimesFile((folder / "times.txt").string());
    const std::map<std::string, fs::path> images = imagesByName(folder / images_subfolder);
    for (ImageTime& time : times_) {
      const auto found = images.find(nameOfImage(time.id));
      if (found == images.end()) {
        throw std::runtime_error((folder / images_subfolder / nameOfImage(time.id)).string() +
                                 ".*: no such image, though times.txt lists it");
      }
      files_.push_back(found->second);
      if (images_subfolder != kFolderOfExposures) {
        time.exposure.reset();
      }
    }
    if (!depth.subfolder.empty()) findDepths(folder / depth.subfolder);
  }

  CameraCalibration calibration() const override { return calibration_; }
  std::size_t size() const override { return files_.size(); }

  std::optional<CameraImage> next() override {
    if (next_ == files_.size()) {
      return std::nullopt;
    }
    const ImageTime& time = times_[next_];
    const fs::path& file = files_[next_];
    CameraImage result;
    result.sequence = next_++;
    result.stamp_ns = result.mid_exposure_ns = time.mid_exposure_ns;
    result.exposure = time.exposure;
    result.image = readImageFile(file);
    if (result.image.empty()) {
      result.problem = file.string() + ": not a readable image";
    } else {
      requireSize(file, "image", result.image);
      const auto depth = depth_files_.find(time.id);
      if (depth != depth_files_.end()) readDepth(depth->second, result);
    }
    return result;
  }

  bool skip() override {
    if (next_ == files_.size()) return false;
    ++next_;
    return true;
  }

 private:
  void findDepths(const fs::path& folder) {
    requireFolder(folder);
    const std::map<std::string, fs::path> images = imagesByName(folder);
    for (const ImageTime& time : times_) {
      const auto found = images.find(nameOfImage(time.id));
      if (found != images.end()) depth_files_[time.id] = found->second;
    }
    if (depth_files_.empty()) {
      throw std::runtime_error(folder.string() + ": no depth image of any image that times.txt lists, e.g. " +
                               nameOfImage(times_.empty() ? 0 : times_.front().id) + ".png");
    }
  }

  void readDepth(const fs::path& file, CameraImage& result) const {
    const cv::Mat depth = readImageFile(file);
    if (depth.empty()) {
      result.problem = file.string() + ": not a readable depth image";
      return;
    }
    requireSize(file, "depth image", depth);
    try {
      result.depth = depthInMetres(depth, depth_units_);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(file.string() + ": " + error.what());
    }
  }

  void requireSize(const fs::path& file, const char* what, const cv::Mat& image) const {
    if (image.cols == calibration_.width && image.rows == calibration_.height) return;
    std::ostringstream message;
    message << file.string() << ": " << what << " is " << image.cols << "x" << image.rows << " px, camera.yaml says "
            << calibration_.width << "x" << calibration_.height;
    throw std::runtime_error(message.str());
  }

  static void requireFolder(const fs::path& folder) {
    if (!fs::is_directory(folder)) {
      throw std::runtime_error(folder.string() + ": no such folder");
    }
  }

  CameraCalibration calibration_;
  std::vector<ImageTime> times_;
  std::vector<fs::path> files_;                    // by position, like times_
  std::map<std::uint64_t, fs::path> depth_files_;  // by id
  double depth_units_;                             // per metre
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<SequenceReader> openSequenceFolder(const std::string& folder, const std::string& images_subfolder,
                                                   const DepthFolder& depth) {
  return std::make_unique<SequenceFolder>(folder, images_subfolder, depth);
}

}  // namespace mba_vo
