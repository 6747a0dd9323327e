#include "mba_vo/ros/bag_reader.h"

#include <stdexcept>

#include <mba_vo/ExposureStamped.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>

#include "bag_topics.h"
#include "mba_vo/ros/bag_errors.h"
#include "mba_vo/ros/camera_info.h"
#include "mba_vo/ros/compressed_image.h"
#include "mba_vo/ros/depth_lookup.h"
#include "mba_vo/ros/exposure_lookup.h"
#include "mba_vo/ros/image_conversion.h"

namespace mba_vo {
namespace {

class BagReader final : public SequenceReader {
 public:
  BagReader(const std::string& file, const BagTopics& wanted) : file_(file), depths_(wanted.depth_tolerance) {
    try {
      bag_.open(file, rosbag::bagmode::Read);
      topics_ = findBagTopics(bag_, file, wanted);
      readCalibration();
      readExposures();
      images_.addQuery(bag_, rosbag::TopicQuery(topics_.image));
      next_ = images_.begin();
      size_ = images_.size();
      if (!topics_.depth.empty()) depth_images_.addQuery(bag_, rosbag::TopicQuery(topics_.depth));
      next_depth_ = depth_images_.begin();
    } catch (const rosbag::BagException& error) {
      throw cannotRead(file, error);
    }
  }

  CameraCalibration calibration() const override { return calibration_; }
  std::size_t size() const override { return size_; }

  std::optional<CameraImage> next() override {
    if (next_ == images_.end()) {
      return std::nullopt;
    }
    try {
      CameraImage image = read(*next_);
      ++next_;
      findDepth(image);
      return image;
    } catch (const rosbag::BagException& error) {
      throw std::runtime_error("image " + std::to_string(sequence_) + ": " + cannotRead(file_, error).what());
    }
  }

 private:
  void readCalibration() {
    if (topics_.calibration) {
      calibration_ = *topics_.calibration;
      return;
    }
    rosbag::View view(bag_, rosbag::TopicQuery(topics_.camera_info));
    const auto info = view.begin() == view.end() ? nullptr : view.begin()->instantiate<sensor_msgs::CameraInfo>();
    if (!info) {
      throw std::runtime_error("bag '" + file_ + "' has no message on " + topics_.camera_info);
    }
    try {
      calibration_ = calibrationFromCameraInfo(*info, topics_.rectified);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error("bag '" + file_ + "', topic " + topics_.camera_info + ": " + error.what());
    }
  }

  void readExposures() {
    if (topics_.exposure.empty()) {
      return;
    }
    rosbag::View view(bag_, rosbag::TopicQuery(topics_.exposure));
    for (const rosbag::MessageInstance& message : view) {
      if (const auto exposure = message.instantiate<ExposureStamped>()) {
        exposures_.add(toNanoseconds(exposure->header.stamp), exposure->exposure_time);
      }
    }
  }

  CameraImage read(const rosbag::MessageInstance& message) {
    CameraImage result;
    if (const auto raw = message.instantiate<sensor_msgs::Image>()) {
      describe(raw->header, result);
      decode([&] { return toCvImage(raw)->image.clone(); }, result);
    } else if (const auto compressed = message.instantiate<sensor_msgs::CompressedImage>()) {
      describe(compressed->header, result);
      decode([&] { return toCvImage(decodeImage(*compressed))->image.clone(); }, result);
    }
    return result;
  }

  void describe(const std_msgs::Header& header, CameraImage& result) {
    result.sequence = sequence_++;
    result.stamp_ns = toNanoseconds(header.stamp);
    const std::optional<double> exposure = exposures_.find(result.stamp_ns);
    result.exposure = exposure ? exposureFromMessage(*exposure) : std::nullopt;
    result.mid_exposure_ns = midExposure(result.stamp_ns, result.exposure, topics_.stamp_reference);
  }

  /// Depth images lie in the bag in about the order of their stamps.
  void findDepth(CameraImage& result) {
    while (!depths_.isSettled(result.stamp_ns) && next_depth_ != depth_images_.end()) {
      if (const auto depth = next_depth_->instantiate<sensor_msgs::Image>()) depths_.add(depth);
      ++next_depth_;
    }
    const sensor_msgs::ImageConstPtr depth = depths_.find(result.stamp_ns);
    if (!depth || result.image.empty()) return;
    try {
      result.depth = depthFromMessage(depth);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error("bag '" + file_ + "', topic " + topics_.depth + ": " + error.what());
    }
  }

  template <typename Decoder>
  void decode(const Decoder& decoder, CameraImage& result) const {
    try {
      result.image = decoder();
    } catch (const std::exception& error) {
      result.problem = error.what();
    }
    if (result.image.empty() && result.problem.empty()) {
      result.problem = "not a readable image";
    }
  }

  std::string file_;
  rosbag::Bag bag_;
  BagTopics topics_;
  CameraCalibration calibration_;
  ExposureLookup exposures_;
  rosbag::View images_;
  rosbag::View::iterator next_;
  DepthLookup depths_;
  rosbag::View depth_images_;
  rosbag::View::iterator next_depth_;
  std::size_t size_ = 0;
  std::uint64_t sequence_ = 0;
};

}  // namespace

std::unique_ptr<SequenceReader> openBag(const std::string& file, const BagTopics& topics) {
  return std::make_unique<BagReader>(file, topics);
}

}  // namespace mba_vo
