#include "mba_vo/ros/bag_image_writer.h"

#include <cmath>
#include <stdexcept>

#include <cv_bridge/cv_bridge.h>
#include <mba_vo/ExposureStamped.h>

#include "mba_vo/ros/camera_info.h"
#include "mba_vo/ros/image_conversion.h"

namespace mba_vo {

BagImageWriter::BagImageWriter(const std::string& file, const CameraCalibration& calibration,
                               StampReference stamp_reference)
    : file_(file),
      bag_(std::make_unique<rosbag::Bag>()),
      camera_info_(cameraInfoFromCalibration(calibration)),
      stamp_reference_(stamp_reference) {
  guarded([&] { bag_->open(file_, rosbag::bagmode::Write); });
  bag_->setCompression(rosbag::compression::LZ4);  // bz2 would read back at a few images a second
  header_.frame_id = "camera_optical";
}

BagImageWriter::~BagImageWriter() {
  try {
    if (bag_) close();
  } catch (const std::runtime_error&) {  // who wants to know calls close()
  }
}

void BagImageWriter::write(std::int64_t mid_exposure_ns, std::optional<double> exposure, const cv::Mat& image) {
  const std::int64_t half = std::llround(0.5e9 * exposure.value_or(0.0));
  const std::int64_t stamp = stampOf(mid_exposure_ns, exposure, stamp_reference_);
  // Zero means "no time" in ROS, and the seconds of a stamp are 32 bits wide.
  if (stamp <= 0 || mid_exposure_ns + half >= (std::int64_t{1} << 32) * 1'000'000'000) {
    throw std::runtime_error("image time is " + std::to_string(1e-9 * static_cast<double>(stamp)) +
                             " s; a bag holds times above 0 and below 2^32 s");
  }
  header_.stamp = toRosTime(stamp);
  record_time_ = toRosTime(mid_exposure_ns + half);
  camera_info_.header = header_;
  writeMessage("/camera/camera_info", camera_info_);
  ExposureStamped exposure_message;
  exposure_message.header = header_;
  exposure_message.exposure_time = exposureToMessage(exposure);
  writeMessage("/camera/exposure", exposure_message);
  writeImage("/camera/image_raw", image);
  ++header_.seq;
}

void BagImageWriter::writeImage(const std::string& topic, const cv::Mat& image) {
  writeMessage(topic, cv_bridge::CvImage(header_, encodingOf(image), image).toImageMsg());
}

}  // namespace mba_vo
