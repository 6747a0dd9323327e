#include "mba_vo/ros/bag_inspection.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include <mba_vo/ExposureStamped.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>

#include "bag_contents.h"
#include "bag_topics.h"
#include "mba_vo/inspection/camera_inspection.h"
#include "mba_vo/inspection/judgements.h"
#include "mba_vo/io/camera_file.h"
#include "mba_vo/ros/camera_info.h"
#include "mba_vo/ros/compressed_image.h"
#include "mba_vo/ros/conversions.h"
#include "mba_vo/ros/image_conversion.h"

namespace mba_vo {
namespace {

/// What a file that cannot be opened is.
Finding whyUnreadable(const std::string& file, const std::string& error) {
  constexpr std::array<char, 9> kBegin{'#', 'R', 'O', 'S', 'B', 'A', 'G', ' ', 'V'};
  std::array<char, kBegin.size()> begin{};
  std::ifstream(file, std::ios::binary).read(begin.data(), begin.size());
  if (begin != kBegin) return {Check::kNotABag, "the file does not begin as a bag does (" + error + ")"};
  return {Check::kNeedsReindex, "its index is missing: recording was cut off, or it was not copied to its end (" +
                                    error + "); rosbag reindex " + file};
}

/// Decoders make something of half an image, too, and say so nowhere.
bool endsEarly(const sensor_msgs::CompressedImage& message) {
  const std::vector<std::uint8_t>& data = message.data;
  constexpr std::ptrdiff_t kPadding = 64;  // bytes that some cameras append
  const auto tail = data.end() - std::min<std::ptrdiff_t>(kPadding, data.end() - data.begin());
  const auto has = [&](const std::vector<std::uint8_t>& mark) {
    return std::search(tail, data.end(), mark.begin(), mark.end()) != data.end();
  };
  const bool is_jpeg = data.size() > 1 && data[0] == 0xFF && data[1] == 0xD8;
  const bool is_png = data.size() > 3 && data[1] == 'P' && data[2] == 'N' && data[3] == 'G';
  return (is_jpeg && !has({0xFF, 0xD9})) || (is_png && !has({'I', 'E', 'N', 'D'}));
}

/// Of one camera of a bag.
class BagCamera {
 public:
  BagCamera(const rosbag::Bag& bag, const BagContents& contents, const std::string& file, const std::string& topic,
            const BagInspectionOptions& options)
      : bag_(bag), contents_(contents), file_(file) {
    source_.name = source_.image = topic;
    source_.exposure = exposureTopicFor(contents, topic);
    source_.compressed = contents.at(topic).type == "sensor_msgs/CompressedImage";
    source_.calibration_file = options.calibration_file;
    source_.camera = options.camera;
  }

  CameraReport inspect(const std::function<void()>& progress) {
    if (source_.calibration_file.empty()) {
      readCameraInfo();
    } else {
      readCalibrationFile();
    }
    readExposures();
    notice(source_.image, forEachMessage(bag_, source_.image, [&](const rosbag::MessageInstance& message) {
             progress();
             addImage(message);
           }));
    CameraReport report;
    report.source = source_;
    report.facts = camera_.facts();
    report.findings = std::move(findings_);
    const std::vector<Finding> judged = judge(report.facts);
    report.findings.insert(report.findings.end(), judged.begin(), judged.end());
    return report;
  }

 private:
  void say(Check check, const std::string& what) { findings_.push_back({check, what}); }

  void notice(const std::string& topic, const Broken& broken) {
    if (broken.messages == 0) return;
    say(Check::kDamagedBag, std::to_string(broken.messages) + " of " + std::to_string(contents_.at(topic).messages) +
                                " messages of " + topic + " cannot be read, the first because: " + broken.first);
  }

  void readCalibrationFile() {
    try {
      camera_.setCalibration(readChosenCamera(source_.calibration_file, source_.camera).calibration);
    } catch (const std::runtime_error& error) {
      say(Check::kBadCameraInfo, error.what());
    }
  }

  void readCameraInfo() {
    BagTopics wanted;
    wanted.image = source_.image;
    wanted.exposure = source_.exposure;
    try {
      source_.camera_info = findBagTopics(bag_, file_, wanted).camera_info;
    } catch (const std::runtime_error& error) {
      say(Check::kNoCameraInfo, error.what());
      return;
    }
    std::vector<sensor_msgs::CameraInfoConstPtr> infos;
    const Broken broken = forEachMessage(bag_, source_.camera_info, [&](const rosbag::MessageInstance& message) {
      if (const auto info = message.instantiate<sensor_msgs::CameraInfo>()) infos.push_back(info);
    });
    notice(source_.camera_info, broken);
    if (infos.empty()) {
      if (broken.messages == 0) say(Check::kNoCameraInfo, source_.camera_info + " has no message");
      return;
    }
    try {
      compare(infos);
    } catch (const std::invalid_argument& error) {
      say(Check::kBadCameraInfo, source_.camera_info + ": " + error.what());
    }
  }

  void compare(const std::vector<sensor_msgs::CameraInfoConstPtr>& infos) {
    const CameraCalibration first = calibrationFromCameraInfo(*infos.front(), false);
    camera_.setCalibration(first);
    const auto others = std::count_if(infos.begin(), infos.end(), [&](const sensor_msgs::CameraInfoConstPtr& info) {
      return !(calibrationFromCameraInfo(*info, false) == first);
    });
    if (others > 0) {
      say(Check::kCameraInfoChanges,
          std::to_string(others) + " of " + std::to_string(infos.size()) + " camera_info differ from the first");
    }
  }

  void readExposures() {
    if (source_.exposure.empty()) return;
    notice(source_.exposure, forEachMessage(bag_, source_.exposure, [&](const rosbag::MessageInstance& message) {
             const auto exposure = message.instantiate<ExposureStamped>();
             if (exposure) camera_.addExposure(toNanoseconds(exposure->header.stamp), exposure->exposure_time);
           }));
  }

  void addImage(const rosbag::MessageInstance& message) {
    SeenImage seen;
    cv_bridge::CvImageConstPtr pixels;  // own them while they are looked at
    try {
      if (const auto raw = message.instantiate<sensor_msgs::Image>()) {
        seen.stamp_ns = toNanoseconds(raw->header.stamp);
        seen.encoding = raw->encoding;
        seen.bad_encoding = raw->step > 0 && raw->data.size() == std::size_t{raw->step} * raw->height;
        pixels = toCvImage(raw);
      } else if (const auto compressed = message.instantiate<sensor_msgs::CompressedImage>()) {
        seen.stamp_ns = toNanoseconds(compressed->header.stamp);
        seen.encoding = compressed->format;
        if (compressed->format.find("jp") != std::string::npos) camera_.setJpeg();
        if (endsEarly(*compressed)) throw std::invalid_argument("the compressed image ends too early");
        pixels = toCvImage(decodeImage(*compressed));
      }
      if (pixels) seen.image = pixels->image;
    } catch (const rosbag::BagException&) {
      throw;  // it is the bag that is broken
    } catch (const std::exception& error) {
      seen.problem = error.what();
    }
    camera_.add(seen);
  }

  const rosbag::Bag& bag_;
  const BagContents& contents_;
  const std::string& file_;
  RecordedCamera source_;
  CameraInspection camera_;
  std::vector<Finding> findings_;
};

void describeContents(const rosbag::Bag& bag, const BagContents& contents, InspectionReport& report) {
  report.contents.push_back("bag of " + std::to_string(bag.getSize() / 1000) + " kB");
  for (const auto& [name, topic] : contents) {
    report.contents.push_back(name + ": " + std::to_string(topic.messages) + " " + topic.type +
                              (topic.is_depth ? " (depths)" : ""));
  }
}

/// Those to look at.
std::vector<std::string> chooseTopics(const BagContents& contents, const std::string& wanted,
                                      InspectionReport& report) {
  const std::vector<std::string> topics = imageTopics(contents);
  std::string list;
  for (const std::string& topic : topics) list += (list.empty() ? "" : ", ") + topic;
  if (topics.empty()) {
    report.findings.push_back({Check::kNoImages, "no topic is of type sensor_msgs/Image or CompressedImage"});
  } else if (!wanted.empty()) {
    if (std::find(topics.begin(), topics.end(), wanted) != topics.end()) return {wanted};
    report.findings.push_back({Check::kNoImages, "'" + wanted + "' is no topic with images; there are: " + list});
    return {};
  } else if (topics.size() > 1) {
    report.findings.push_back({Check::kSeveralCameras, "there are images on " + list});
  }
  return topics;
}

}  // namespace

InspectionReport inspectBag(const std::string& file, const BagInspectionOptions& options,
                            const InspectionProgress& progress) {
  InspectionReport report;
  report.path = file;
  report.is_bag = true;
  rosbag::Bag bag;
  BagContents contents;
  try {
    bag.open(file, rosbag::bagmode::Read);
    contents = contentsOf(bag);
  } catch (const std::exception& error) {
    report.readable = false;
    report.findings.push_back(whyUnreadable(file, error.what()));
    return report;
  }
  describeContents(bag, contents, report);
  report.findings = wrongTypes(contents);
  const std::vector<std::string> topics = chooseTopics(contents, options.image_topic, report);
  std::size_t all = 0;
  for (const std::string& topic : topics) all += contents.at(topic).messages;
  std::size_t done = 0;
  for (const std::string& topic : topics) {
    BagCamera camera(bag, contents, file, topic, options);
    report.cameras.push_back(camera.inspect([&] { progress(++done, all); }));
  }
  return report;
}

}  // namespace mba_vo
