#include "sequence_camera.h"

#include <cv_bridge/cv_bridge.h>
#include <mba_vo/ExposureStamped.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>

#include "mba_vo/ros/camera_info.h"
#include "mba_vo/ros/conversions.h"

namespace mba_vo {

SequenceCamera::SequenceCamera(const std::string& ns, const std::vector<CameraImage>& images,
                               const CameraCalibration& calibration, const std::string& transport)
    : images_(images),
      compressed_(transport == "compressed"),
      info_(cameraInfoFromCalibration(calibration)),
      nh_(ns),
      image_publisher_(compressed_ ? nh_.advertise<sensor_msgs::CompressedImage>("image_raw/compressed", 100)
                                   : nh_.advertise<sensor_msgs::Image>("image_raw", 100)),
      info_publisher_(nh_.advertise<sensor_msgs::CameraInfo>("camera_info", 100)),
      exposure_publisher_(nh_.advertise<ExposureStamped>("exposure", 100)),
      clock_publisher_(nh_.advertise<rosgraph_msgs::Clock>("/clock", 100)) {}

bool SequenceCamera::waitForReaders(double timeout) const {
  const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(timeout);
  const auto isRead = [](const ros::Publisher& publisher) { return publisher.getNumSubscribers() > 0; };
  while (!isRead(image_publisher_) || !isRead(info_publisher_) || !isRead(exposure_publisher_)) {
    if (ros::WallTime::now() > deadline) return false;
    ros::WallDuration(0.01).sleep();
  }
  return true;
}

void SequenceCamera::send(std::size_t index, bool covered) {
  const CameraImage& image = images_.at(index);
  rosgraph_msgs::Clock clock;
  clock.clock = toRosTime(image.stamp_ns);
  clock_publisher_.publish(clock);
  info_.header.stamp = clock.clock;
  info_.header.frame_id = "camera_optical";
  info_publisher_.publish(info_);
  ExposureStamped exposure;
  exposure.header = info_.header;
  exposure.exposure_time = exposureToMessage(image.exposure);
  exposure_publisher_.publish(exposure);
  const cv::Mat pixels = covered ? cv::Mat::zeros(image.image.size(), image.image.type()) : image.image;
  const cv_bridge::CvImage message(info_.header, sensor_msgs::image_encodings::MONO8, pixels);
  if (compressed_) {
    image_publisher_.publish(message.toCompressedImageMsg(cv_bridge::PNG));
  } else {
    image_publisher_.publish(message.toImageMsg());
  }
  ++sent_;
}

}  // namespace mba_vo
