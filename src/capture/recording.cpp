#include "mba_vo/capture/recording.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <vector>

#include "mba_vo/capture/camera_source.h"
#include "mba_vo/io/camera_file.h"
#include "mba_vo/io/image_files.h"
#include "mba_vo/io/sequence.h"
#include "video_file.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

constexpr double kUntimedRate = 30.0;  // of images that have no times [Hz]

/// Names with numbers in the order of the numbers: image_9 before image_10. Other names follow the alphabet.
bool comesBefore(const std::string& a, const std::string& b) {
  const auto number = [](const std::string& name) {
    const std::size_t last = name.find_last_not_of("0123456789");
    std::string digits = name.substr(last == std::string::npos ? 0 : last + 1);
    digits.erase(0, digits.find_first_not_of('0'));
    return std::make_pair(name.substr(0, last == std::string::npos ? 0 : last + 1), digits);
  };
  const auto [text_a, digits_a] = number(a);
  const auto [text_b, digits_b] = number(b);
  if (text_a != text_b || digits_a == digits_b) return a < b;
  return digits_a.size() != digits_b.size() ? digits_a.size() < digits_b.size() : digits_a < digits_b;
}

class ImageFolder : public Recording {
 public:
  ImageFolder(const fs::path& folder, double rate) : folder_(folder), rate_(rate > 0.0 ? rate : kUntimedRate) {
    std::vector<std::pair<std::string, fs::path>> images;
    for (const auto& image : imagesByName(folder)) images.push_back(image);
    std::sort(images.begin(), images.end(), [](const auto& a, const auto& b) { return comesBefore(a.first, b.first); });
    for (const auto& image : images) files_.push_back(image.second);
    if (files_.empty()) {
      throw CameraError(folder_.string() + ": no images (.png, .jpg, ...), and no times.txt of a sequence folder");
    }
  }

  std::optional<RecordedImage> next() override {
    if (next_ == files_.size()) return std::nullopt;
    RecordedImage result;
    result.time_ns = std::llround(1e9 * static_cast<double>(next_) / rate_);
    const fs::path& file = files_[next_++];
    result.image = readImage(file);
    if (result.image.empty()) result.problem = file.string() + ": not a readable image";
    return result;
  }
  void rewind() override { next_ = 0; }

  std::string description() const override {
    std::ostringstream text;
    text << folder_.string() << ": " << files_.size() << " images at " << rate_ << " Hz";
    return text.str();
  }

 private:
  fs::path folder_;
  double rate_;  // [Hz]
  std::vector<fs::path> files_;
  std::size_t next_ = 0;
};

class SequencePlayer : public Recording {
 public:
  SequencePlayer(const std::string& folder, const std::string& images, const std::string& camera)
      : folder_(folder), images_(images), camera_(camera) {
    open();
  }

  std::optional<RecordedImage> next() override {
    const std::optional<CameraImage> image = reader_->next();
    if (!image) return std::nullopt;
    return RecordedImage{image->image, image->mid_exposure_ns, image->exposure, image->problem};
  }
  void rewind() override { open(); }

  std::string description() const override {
    return folder_ + ": sequence of " + std::to_string(reader_->size()) + " images, times and exposures of times.txt";
  }
  std::string calibrationFile() const override { return cameraFileIn(fs::absolute(folder_).string()); }

 private:
  void open() {
    try {
      reader_ = openSequenceFolder(folder_, images_, {}, "", camera_);
    } catch (const std::runtime_error& error) {
      throw CameraError(error.what());
    }
  }

  std::string folder_;
  std::string images_;
  std::string camera_;
  std::unique_ptr<SequenceReader> reader_;
};

}  // namespace

std::unique_ptr<Recording> openRecording(const std::string& path, double rate, const std::string& images_subfolder,
                                         const std::string& camera) {
  if (!fs::exists(path)) throw CameraError(path + ": no such device, file or folder");
  if (!fs::is_directory(path)) return openVideoFile(path, rate);
  if (!fs::exists(fs::path(path) / "times.txt")) return std::make_unique<ImageFolder>(path, rate);
  if (rate > 0.0) {
    std::ostringstream text;
    text << path << ": rate is " << rate
         << " Hz; the images of a sequence folder come at the times of its times.txt (rate 0)";
    throw CameraError(text.str());
  }
  return std::make_unique<SequencePlayer>(path, images_subfolder, camera);
}

}  // namespace mba_vo
