#include "bag_topics.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <vector>

#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>

namespace mba_vo {

const char* const kGroundTruthNamespace = "/groundtruth/";

namespace {

constexpr const char* kImageType = "sensor_msgs/Image";
constexpr const char* kCompressedType = "sensor_msgs/CompressedImage";

using TopicTypes = std::map<std::string, std::string>;  // topic -> type

TopicTypes topicsOf(const rosbag::Bag& bag) {
  TopicTypes topics;
  rosbag::View view(bag);
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    if (connection->topic.rfind(kGroundTruthNamespace, 0) != 0) {
      topics[connection->topic] = connection->datatype;
    }
  }
  return topics;
}

std::vector<std::string> ofTypes(const TopicTypes& topics, const std::vector<std::string>& types) {
  std::vector<std::string> names;
  for (const auto& [topic, type] : topics) {
    if (std::find(types.begin(), types.end(), type) != types.end()) {
      names.push_back(topic);
    }
  }
  return names;
}

std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text.empty() ? "none" : text;
}

/// One topic of the given types: the wanted one, or the only one, or "" if there is none to be found.
std::string choose(const TopicTypes& topics, const std::string& file, const std::string& what,
                   const std::string& wanted, const std::vector<std::string>& types) {
  const std::vector<std::string> candidates = ofTypes(topics, types);
  if (!wanted.empty()) {
    if (std::find(candidates.begin(), candidates.end(), wanted) == candidates.end()) {
      throw std::runtime_error("bag '" + file + "' has no " + what + " topic '" + wanted + "' of type " + join(types) +
                               "; it has: " + join(candidates));
    }
    return wanted;
  }
  if (candidates.size() > 1) {
    throw std::runtime_error("bag '" + file + "' has several " + what + " topics, name one of: " + join(candidates));
  }
  return candidates.empty() ? "" : candidates.front();
}

/// camera_info beside the image, as image_transport and drivers do: /camera/image_raw -> /camera/camera_info.
std::string siblingCameraInfo(const TopicTypes& topics, const std::string& image) {
  std::string ns = image;
  for (int level = 0; level < 2; ++level) {  // a compressed image is one level further down
    ns = ns.substr(0, ns.find_last_of('/') == std::string::npos ? 0 : ns.find_last_of('/'));
    const auto found = topics.find(ns + "/camera_info");
    if (found != topics.end() && found->second == "sensor_msgs/CameraInfo") {
      return found->first;
    }
  }
  return "";
}

bool isDepth(const rosbag::Bag& bag, const std::string& topic) {
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  if (view.begin() == view.end()) return false;
  if (const auto image = view.begin()->instantiate<sensor_msgs::Image>()) {
    return image->encoding == sensor_msgs::image_encodings::TYPE_32FC1;
  }
  const auto compressed = view.begin()->instantiate<sensor_msgs::CompressedImage>();
  return compressed && compressed->format.find("compressedDepth") != std::string::npos;
}

/// The topics but those with images of floats, which are depths, and with what compresses these.
TopicTypes withoutDepths(const rosbag::Bag& bag, TopicTypes topics) {
  for (auto it = topics.begin(); it != topics.end();) {
    const bool is_image = it->second == kImageType || it->second == kCompressedType;
    it = is_image && isDepth(bag, it->first) ? topics.erase(it) : std::next(it);
  }
  return topics;
}

}  // namespace

BagTopics findBagTopics(const rosbag::Bag& bag, const std::string& file, const BagTopics& wanted) {
  const TopicTypes topics = topicsOf(bag);
  BagTopics found = wanted;
  TopicTypes images = topics;
  if (!wanted.depth.empty()) {
    choose(topics, file, "depth", wanted.depth, {kImageType});
    images.erase(wanted.depth);
  }
  const auto chooseImage = [&](const TopicTypes& from) {
    return choose(from, file, "image", wanted.image, {kImageType, kCompressedType});
  };
  found.image = wanted.image.empty() ? chooseImage(withoutDepths(bag, images)) : "";
  if (found.image.empty()) found.image = chooseImage(images);  // that nothing can be read is told image by image
  if (found.image.empty()) {
    throw std::runtime_error("bag '" + file + "' has no topic of type sensor_msgs/Image or CompressedImage");
  }
  if (wanted.camera_info.empty()) {
    found.camera_info = siblingCameraInfo(topics, found.image);
  }
  if (!wanted.calibration) {
    found.camera_info = choose(topics, file, "camera_info", found.camera_info, {"sensor_msgs/CameraInfo"});
    if (found.camera_info.empty()) {
      throw std::runtime_error("bag '" + file +
                               "' has no topic of type sensor_msgs/CameraInfo: the calibration is missing; name a file "
                               "that has it with --calibration");
    }
  }
  found.exposure = choose(topics, file, "exposure", wanted.exposure, {"mba_vo/ExposureStamped"});
  return found;
}

}  // namespace mba_vo
