#include "recording.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <utility>

#include "mba_vo/datasets/dataset.h"

#ifdef MBA_VO_WITH_ROS
#include "mba_vo/io/camera_file.h"
#include "mba_vo/ros/bag_reader.h"
#endif

namespace {

/// "auto" or seconds.
std::string checkExposure(const std::string& text) {
  if (text == "auto") {
    return "";
  }
  constexpr double kLongest = 10.0;  // [s]
  std::size_t used = 0;
  double seconds = -1.0;
  try {
    seconds = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  const bool good = used == text.size() && seconds >= 0.0 && seconds <= kLongest;
  return good ? "" : "exposure '" + text + "': must be auto or 0 to 10 seconds";
}

#ifdef MBA_VO_WITH_ROS
/// A bag without exposures, given one for all images: only now can stamps of start or end be turned into mid-exposure.
class BagOfKnownExposure : public mba_vo::SequenceReader {
 public:
  BagOfKnownExposure(std::unique_ptr<SequenceReader> bag, double exposure, mba_vo::StampReference reference)
      : bag_(std::move(bag)), exposure_(exposure), reference_(reference) {}
  mba_vo::CameraCalibration calibration() const override { return bag_->calibration(); }
  std::size_t size() const override { return bag_->size(); }
  std::optional<mba_vo::CameraImage> next() override {
    std::optional<mba_vo::CameraImage> image = bag_->next();
    if (image && !image->exposure) {
      image->mid_exposure_ns = mba_vo::midExposure(image->stamp_ns, exposure_, reference_);
    }
    return image;
  }

 private:
  std::unique_ptr<SequenceReader> bag_;
  double exposure_;  // [s]
  mba_vo::StampReference reference_;
};

std::unique_ptr<mba_vo::SequenceReader> openBag(const RecordingArguments& a) {
  mba_vo::BagTopics topics;
  topics.image = a.image_topic;
  topics.camera_info = a.camera_info_topic;
  topics.exposure = a.exposure_topic;
  topics.depth = a.depth_topic;
  topics.depth_tolerance = a.depth_tolerance;
  topics.stamp_reference = mba_vo::parseStampReference(a.stamp_reference);
  topics.rectified = a.rectified;
  if (!a.camera.empty() && a.calibration.empty()) {
    throw std::runtime_error("--camera " + a.camera +
                             ": for a bag it chooses from --calibration, which is not told; topics by --image-topic");
  }
  if (!a.calibration.empty()) topics.calibration = mba_vo::readChosenCamera(a.calibration, a.camera).calibration;
  auto bag = mba_vo::openBag(a.sequence, topics);
  const std::optional<double> exposure = exposureOverride(a);
  if (!exposure) {
    return bag;
  }
  return std::make_unique<BagOfKnownExposure>(std::move(bag), *exposure, topics.stamp_reference);
}
#else
std::unique_ptr<mba_vo::SequenceReader> openBag(const RecordingArguments& a) {
  throw std::runtime_error(a.sequence + ": this program was built without ROS (MBA_VO_ROS=OFF) and cannot read bags");
}
#endif

mba_vo::Dataset openFolder(const RecordingArguments& a) {
  return mba_vo::openDataset(a.sequence, {a.images, a.depth, a.calibration, a.camera});
}

}  // namespace

void describeRecording(CLI::App& app, RecordingArguments& a) {
  app.add_option("SEQUENCE", a.sequence, "folder of a sequence or of a known data set, or .bag file");
  app.add_option("--calibration", a.calibration,
                 "file with the calibration of the camera (ROS, Kalibr, ASL, TUM-mono), in place of the recording's")
      ->check(CLI::ExistingFile);
  app.add_option("--camera", a.camera, "which of several cameras of a folder or a calibration: cam0, cam1, ...");
  app.add_option("--images", a.images, "sub-folder with the images of a sequence folder")->capture_default_str();
  app.add_option(
      "--depth", a.depth.subfolder,
      "sub-folder with depth images of a sequence folder: the map then begins at once, and its scale is theirs");
  app.add_option("--depth-units", a.depth.units_per_metre, "units per metre of 16-bit depth images")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e6));
  app.add_option("--exposure", a.exposure, "auto = as recorded, or seconds for all images; 0 = treat as sharp")
      ->capture_default_str()
      ->check(checkExposure);
  app.add_option("--row-time", a.row_time,
                 "rolling shutter: seconds from one row to the next; default: image.row_time of the configuration")
      ->check(CLI::Range(-1e-3, 1e-3));
  app.add_option("--skip", a.skip, "images to leave out at the beginning")->capture_default_str();
  app.add_option("--frames", a.frames, "most images to take after these, 0 = all")->capture_default_str();
  app.add_option("--image-topic", a.image_topic, "of the bag; found by type if there is only one");
  app.add_option("--camera-info-topic", a.camera_info_topic, "of the bag; found beside the image topic");
  app.add_option("--exposure-topic", a.exposure_topic, "of the bag; found by type if there is only one");
  app.add_option("--depth-topic", a.depth_topic,
                 "of the bag: depth images in metres or millimetres; none if not named");
  app.add_option("--depth-tolerance", a.depth_tolerance, "most seconds between the stamps of image and depth image")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--stamp-reference", a.stamp_reference, "what the bag's image stamps refer to: start, middle or end")
      ->capture_default_str()
      ->check(CLI::IsMember({"start", "middle", "end"}));
  app.add_flag("--rectified", a.rectified, "the bag's images are rectified already");
}

std::optional<double> exposureOverride(const RecordingArguments& a) {
  return a.exposure == "auto" ? std::nullopt : std::optional<double>(std::stod(a.exposure));
}

std::unique_ptr<mba_vo::ProgressBar> progressBar(const RecordingArguments& a, const mba_vo::SequenceReader& reader) {
  const std::size_t end = a.frames > 0 ? std::min(reader.size(), a.skip + a.frames) : reader.size();
  return std::make_unique<mba_vo::ProgressBar>(std::cerr, end, isatty(STDERR_FILENO) == 1, a.skip);
}

void adoptWhatIsKnown(const RecordingArguments& a, mba_vo::FrameBuilderConfig& config, std::ostream& log) {
  if (!std::filesystem::is_directory(a.sequence)) return;
  const mba_vo::Dataset dataset = openFolder(a);
  dataset.configure(config);
  for (const std::string& note : dataset.notes) log << dataset.form << ": " << note << "\n";
}

std::unique_ptr<mba_vo::SequenceReader> openSequence(const RecordingArguments& a) {
  if (!std::filesystem::exists(a.sequence)) {
    throw std::runtime_error(a.sequence + ": no such sequence folder or bag");
  }
  return std::filesystem::is_directory(a.sequence) ? openFolder(a).reader : openBag(a);
}
