#include "mba_vo/ros/topic_advice.h"

namespace mba_vo {
namespace {

constexpr const char* kImage = "sensor_msgs/Image";
constexpr const char* kCompressed = "sensor_msgs/CompressedImage";
const std::string kCompressedSuffix = "/compressed";

bool isPublished(const std::string& topic, const std::string& type, const TopicTypes& published) {
  const auto found = published.find(topic);
  return found != published.end() && found->second == type;
}

std::string withoutSuffix(const std::string& topic) {
  const std::size_t length = kCompressedSuffix.size();
  const bool has = topic.size() > length && topic.compare(topic.size() - length, length, kCompressedSuffix) == 0;
  return has ? topic.substr(0, topic.size() - length) : topic;
}

std::string topicsOf(const std::string& type, const TopicTypes& published) {
  std::string names;
  for (const auto& [topic, its_type] : published) {
    if (its_type == type) names += (names.empty() ? "" : ", ") + topic;
  }
  return names.empty() ? "none" : names;
}

}  // namespace

std::string whyNothingComes(const std::string& topic, const std::string& type, const TopicTypes& published) {
  const auto found = published.find(topic);
  if (found != published.end()) {
    if (found->second == type) return "";
    std::string text = "it is published as " + found->second + ", " + type + " is needed";
    if (type == kImage && found->second == kCompressed) {
      text += ": tell image:=" + withoutSuffix(topic) + " image_transport:=compressed";
    }
    return type == kExposureType ? text + ": exposure_relay makes it" : text;
  }
  if (type == kImage && isPublished(topic + kCompressedSuffix, kCompressed, published)) {
    return "only " + topic + kCompressedSuffix + " is published: tell image_transport:=compressed";
  }
  if (type == kCompressed && isPublished(withoutSuffix(topic), kImage, published)) {
    return "only " + withoutSuffix(topic) + " is published: tell image_transport:=raw";
  }
  return "nobody publishes it; topics of type " + type + ": " + topicsOf(type, published);
}

}  // namespace mba_vo
