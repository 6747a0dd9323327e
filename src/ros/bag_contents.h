#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <rosbag/bag.h>
#include <rosbag/message_instance.h>

#include "mba_vo/inspection/finding.h"

namespace mba_vo {

struct BagTopic {
  std::string type;
  std::size_t messages = 0;
  bool is_depth = false;         // images of depths
  bool known_definition = true;  // of the message, as this program was built with
};

using BagContents = std::map<std::string, BagTopic>;  // by topic, without the ground truth

BagContents contentsOf(const rosbag::Bag& bag);

/// Topics with images of light.
std::vector<std::string> imageTopics(const BagContents& contents);

/// The topic of exposures that is nearest by name to the topic of the images; empty if there is none.
std::string exposureTopicFor(const BagContents& contents, const std::string& image_topic);

/// Topics that by their name should be read, but by their type cannot be.
std::vector<Finding> wrongTypes(const BagContents& contents);

/// Calls `use` with each message of a topic. What is thrown is counted, and the next one follows.
struct Broken {
  std::size_t messages = 0;
  std::string first;  // why
};
Broken forEachMessage(const rosbag::Bag& bag, const std::string& topic,
                      const std::function<void(const rosbag::MessageInstance&)>& use);

}  // namespace mba_vo
