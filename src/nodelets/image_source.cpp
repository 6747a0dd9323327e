#include "image_source.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include <boost/make_shared.hpp>

#include "mba_vo/ros/compressed_image.h"

namespace mba_vo {
namespace {

constexpr std::uint32_t kQueue = 100;  // shorter ones lose images without a word under load
constexpr const char* kCompressed = "compressed";

void requireTransport(const image_transport::ImageTransport& transport, const std::string& parameter,
                      const std::string& wanted) {
  std::set<std::string> allowed = {kCompressed};
  for (const std::string& plugin : transport.getLoadableTransports()) {
    allowed.insert(plugin.substr(plugin.find('/') + 1));  // image_transport/raw
  }
  if (allowed.count(wanted) > 0) return;
  std::string names;
  for (const std::string& name : allowed) names += (names.empty() ? "" : ", ") + name;
  throw std::invalid_argument(parameter + " is '" + wanted + "'; allowed: " + names +
                              ", and those whose plugin is installed");
}

}  // namespace

ImageSource::ImageSource(ros::NodeHandle& nh, const ros::NodeHandle& private_nh, const std::string& name,
                         const std::string& parameter, const std::string& transport, Callback callback)
    : callback_(std::move(callback)), transport_(std::make_unique<image_transport::ImageTransport>(nh)) {
  const ros::TransportHints no_delay = ros::TransportHints().tcpNoDelay();
  const image_transport::TransportHints hints(transport, no_delay, private_nh, parameter);
  requireTransport(*transport_, parameter, hints.getTransport());
  if (hints.getTransport() == kCompressed) {
    compressed_ =
        nh.subscribe(nh.resolveName(name) + "/" + kCompressed, kQueue, &ImageSource::onCompressed, this, no_delay);
    return;
  }
  any_ = transport_->subscribe(
      name, kQueue, [this](const sensor_msgs::ImageConstPtr& image) { callback_(image, ""); }, {}, hints);
}

void ImageSource::onCompressed(const sensor_msgs::CompressedImageConstPtr& message) const {
  sensor_msgs::ImageConstPtr image;
  std::string problem;
  try {
    image = decodeImage(*message);
  } catch (const std::invalid_argument& error) {
    problem = error.what();
    const auto header_alone = boost::make_shared<sensor_msgs::Image>();
    header_alone->header = message->header;
    image = header_alone;
  }
  callback_(image, problem);
}

}  // namespace mba_vo
