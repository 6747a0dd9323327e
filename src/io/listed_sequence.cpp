#include "mba_vo/io/listed_sequence.h"

#include <sstream>
#include <stdexcept>
#include <utility>

#include "mba_vo/io/image_files.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

class ListedSequence : public SequenceReader {
 public:
  explicit ListedSequence(ImageList list) : list_(std::move(list)) {}

  CameraCalibration calibration() const override { return list_.calibration; }
  std::size_t size() const override { return list_.images.size(); }

  std::optional<CameraImage> next() override {
    if (next_ == list_.images.size()) return std::nullopt;
    const ListedImage& listed = list_.images[next_];
    CameraImage result;
    result.sequence = next_++;
    result.stamp_ns = result.mid_exposure_ns = listed.mid_exposure_ns;
    result.exposure = listed.exposure;
    result.image = readImage(listed.file);
    if (result.image.empty()) {
      result.problem = listed.file.string() + ": not a readable image";
    } else {
      requireSize(listed.file, "image", result.image);
      if (!listed.depth.empty()) readDepth(listed.depth, result);
    }
    return result;
  }

  bool skip() override {
    if (next_ == list_.images.size()) return false;
    ++next_;
    return true;
  }

 private:
  void readDepth(const fs::path& file, CameraImage& result) const {
    const cv::Mat depth = readImage(file);
    if (depth.empty()) {
      result.problem = file.string() + ": not a readable depth image";
      return;
    }
    requireSize(file, "depth image", depth);
    try {
      result.depth = depthInMetres(depth, list_.depth_units);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(file.string() + ": " + error.what());
    }
  }

  void requireSize(const fs::path& file, const char* what, const cv::Mat& image) const {
    if (image.cols == list_.calibration.width && image.rows == list_.calibration.height) return;
    std::ostringstream message;
    message << file.string() << ": " << what << " is " << image.cols << "x" << image.rows << " px, "
            << list_.calibration_name << " says " << list_.calibration.width << "x" << list_.calibration.height;
    throw std::runtime_error(message.str());
  }

  ImageList list_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<SequenceReader> readListed(ImageList list) { return std::make_unique<ListedSequence>(std::move(list)); }

void requireFolder(const fs::path& folder) {
  if (fs::is_directory(folder)) return;
  const fs::path packed = folder.string() + ".zip";
  if (fs::exists(packed)) {
    throw std::runtime_error(folder.string() + ": no such folder, but its images are packed: unzip -d " +
                             folder.string() + " " + packed.string());
  }
  throw std::runtime_error(folder.string() + ": no such folder");
}

}  // namespace mba_vo
