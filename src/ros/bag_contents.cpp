#include "bag_contents.h"

#include <algorithm>

#include <mba_vo/ExposureStamped.h>
#include <rosbag/view.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>

#include "mba_vo/ros/bag_reader.h"

namespace mba_vo {
namespace {

namespace traits = ros::message_traits;

/// Type -> checksum of its definition, of what is read.
const std::map<std::string, std::string>& readTypes() {
  static const std::map<std::string, std::string> types{
      {traits::datatype<sensor_msgs::Image>(), traits::md5sum<sensor_msgs::Image>()},
      {traits::datatype<sensor_msgs::CompressedImage>(), traits::md5sum<sensor_msgs::CompressedImage>()},
      {traits::datatype<sensor_msgs::CameraInfo>(), traits::md5sum<sensor_msgs::CameraInfo>()},
      {traits::datatype<ExposureStamped>(), traits::md5sum<ExposureStamped>()}};
  return types;
}

bool isImageType(const std::string& type) {
  return type == traits::datatype<sensor_msgs::Image>() || type == traits::datatype<sensor_msgs::CompressedImage>();
}

bool hasDepths(const rosbag::Bag& bag, const std::string& topic) {
  bool depth = topic.find("depth") != std::string::npos || topic.find("disparity") != std::string::npos;
  bool first = true;
  forEachMessage(bag, topic, [&](const rosbag::MessageInstance& message) {
    if (!first) return;
    first = false;
    const auto image = message.instantiate<sensor_msgs::Image>();
    depth = depth || (image && image->encoding == sensor_msgs::image_encodings::TYPE_32FC1);
  });
  return depth;
}

std::string lastPart(const std::string& topic) { return topic.substr(topic.find_last_of('/') + 1); }

/// What a topic of this name should be; empty = anything.
std::string expectedType(const std::string& topic) {
  const std::string name = lastPart(topic);
  if (name == "camera_info") return "sensor_msgs/CameraInfo";
  if (name == "compressed") return "sensor_msgs/CompressedImage";
  if (name.rfind("image", 0) == 0) return "sensor_msgs/Image";
  if (name.find("exposure") != std::string::npos) return "mba_vo/ExposureStamped, which exposure_relay makes of it";
  return "";
}

std::size_t commonPrefix(const std::string& a, const std::string& b) {
  return static_cast<std::size_t>(
      std::mismatch(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(std::min(a.size(), b.size())), b.begin()).first -
      a.begin());
}

}  // namespace

Broken forEachMessage(const rosbag::Bag& bag, const std::string& topic,
                      const std::function<void(const rosbag::MessageInstance&)>& use) {
  Broken broken;
  const auto note = [&broken](const std::exception& error) {
    if (broken.messages++ == 0) broken.first = error.what();
  };
  try {
    rosbag::View view(bag, rosbag::TopicQuery(topic));
    for (const rosbag::MessageInstance& message : view) {
      try {
        use(message);
      } catch (const std::exception& error) {
        note(error);
      }
    }
  } catch (const std::exception& error) {
    note(error);
  }
  return broken;
}

BagContents contentsOf(const rosbag::Bag& bag) {
  BagContents contents;
  rosbag::View all(bag);
  for (const rosbag::ConnectionInfo* connection : all.getConnections()) {
    if (connection->topic.rfind(kGroundTruthNamespace, 0) == 0) continue;
    BagTopic& topic = contents[connection->topic];
    topic.type = connection->datatype;
    const auto known = readTypes().find(connection->datatype);
    if (known != readTypes().end() && known->second != connection->md5sum) topic.known_definition = false;
  }
  for (auto& [name, topic] : contents) {
    topic.messages = rosbag::View(bag, rosbag::TopicQuery(name)).size();
    topic.is_depth = isImageType(topic.type) && hasDepths(bag, name);
  }
  return contents;
}

std::vector<std::string> imageTopics(const BagContents& contents) {
  std::vector<std::string> topics;
  for (const auto& [name, topic] : contents) {
    if (isImageType(topic.type) && topic.known_definition && !topic.is_depth) topics.push_back(name);
  }
  return topics;
}

std::string exposureTopicFor(const BagContents& contents, const std::string& image_topic) {
  std::string best;
  for (const auto& [name, topic] : contents) {
    if (topic.type != traits::datatype<ExposureStamped>() || !topic.known_definition) continue;
    if (best.empty() || commonPrefix(name, image_topic) > commonPrefix(best, image_topic)) best = name;
  }
  return best;
}

std::vector<Finding> wrongTypes(const BagContents& contents) {
  std::vector<Finding> findings;
  for (const auto& [name, topic] : contents) {
    if (!topic.known_definition) {
      findings.push_back(
          {Check::kWrongType, name + " has another definition of " + topic.type + " than this program was built with"});
      continue;
    }
    const std::string expected = expectedType(name);
    if (expected.empty() || readTypes().count(topic.type) != 0) continue;
    findings.push_back({Check::kWrongType, name + " is of type " + topic.type + ", not " + expected});
  }
  return findings;
}

}  // namespace mba_vo
