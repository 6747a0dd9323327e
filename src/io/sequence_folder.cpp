#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iomanip>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

#include "mba_vo/io/camera_yaml.h"
#include "mba_vo/io/sequence.h"
#include "mba_vo/io/times_file.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolderOfExposures = "images";  // times.txt speaks of these images

std::string lowerCaseExtension(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// Name without extension -> file, of every image in `folder`.
std::map<std::string, fs::path> imagesByName(const fs::path& folder) {
  const std::set<std::string> extensions{".webp", ".png", ".jpg", ".jpeg", ".bmp", ".pgm", ".tif", ".tiff"};
  std::map<std::string, fs::path> images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (extensions.count(lowerCaseExtension(entry.path())) != 0) {
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

/// Colour and depth as stored, except that webp knows no grey images.
cv::Mat readImage(const fs::path& file) {
  const int flags = lowerCaseExtension(file) == ".webp" ? cv::IMREAD_GRAYSCALE : cv::IMREAD_UNCHANGED;
  try {
    return cv::imread(file.string(), flags);
  } catch (const cv::Exception&) {
    return {};
  }
}

class SequenceFolder : public SequenceReader {
 public:
  SequenceFolder(const fs::path& folder, const std::string& images_subfolder) {
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
  }

  CameraCalibration calibration() const override { return calibration_; }
  std::size_t size() const override { return files_.size(); }

  std::optional<SequenceImage> next() override {
    if (next_ == files_.size()) {
      return std::nullopt;
    }
    const ImageTime& time = times_[next_];
    const fs::path& file = files_[next_];
    SequenceImage result{next_, time.mid_exposure_ns, time.mid_exposure_ns, time.exposure, readImage(file), ""};
    ++next_;
    if (result.image.empty()) {
      result.problem = file.string() + ": not a readable image";
    } else if (result.image.cols != calibration_.width || result.image.rows != calibration_.height) {
      std::ostringstream message;
      message << file.string() << ": image is " << result.image.cols << "x" << result.image.rows
              << " px, camera.yaml says " << calibration_.width << "x" << calibration_.height;
      throw std::runtime_error(message.str());
    }
    return result;
  }

  bool skip() override {
    if (next_ == files_.size()) return false;
    ++next_;
    return true;
  }

 private:
  static void requireFolder(const fs::path& folder) {
    if (!fs::is_directory(folder)) {
      throw std::runtime_error(folder.string() + ": no such folder");
    }
  }

  CameraCalibration calibration_;
  std::vector<ImageTime> times_;
  std::vector<fs::path> files_;  // by position, like times_
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<SequenceReader> openSequenceFolder(const std::string& folder, const std::string& images_subfolder) {
  return std::make_unique<SequenceFolder>(folder, images_subfolder);
}

}  // namespace mba_vo
