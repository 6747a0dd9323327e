#pragma once

#include <functional>
#include <memory>
#include <string>

#include <image_transport/image_transport.h>
#include <ros/node_handle.h>
#include <sensor_msgs/CompressedImage.h>

namespace mba_vo {

/// A topic of images. Transport "compressed" is read without a plugin, which Debian lacks; others are those of
/// image_transport.
class ImageSource {
 public:
  /// `problem`: why the image could not be decoded; it has its header alone then.
  using Callback = std::function<void(const sensor_msgs::ImageConstPtr&, const std::string& problem)>;

  /// `parameter`: that told the transport, and under which a nodelet may tell another one in its own namespace.
  /// Throws std::invalid_argument naming parameter and transport, and what is allowed, if there is no such transport.
  ImageSource(ros::NodeHandle& nh, const ros::NodeHandle& private_nh, const std::string& name,
              const std::string& parameter, const std::string& transport, Callback callback);

  std::string topic() const { return compressed_ ? compressed_.getTopic() : any_.getTopic(); }
  std::string type() const { return compressed_ ? "sensor_msgs/CompressedImage" : "sensor_msgs/Image"; }
  /// Whether `type` is what comes on the topic; other transports have types of their own.
  bool knowsType() const { return compressed_ || any_.getTransport() == "raw"; }
  std::uint32_t publishers() const { return compressed_ ? compressed_.getNumPublishers() : any_.getNumPublishers(); }

 private:
  void onCompressed(const sensor_msgs::CompressedImageConstPtr& message) const;

  Callback callback_;
  std::unique_ptr<image_transport::ImageTransport> transport_;
  image_transport::Subscriber any_;
  ros::Subscriber compressed_;
};

}  // namespace mba_vo
