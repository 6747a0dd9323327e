#pragma once

#include <map>
#include <string>

namespace mba_vo {

inline constexpr const char* kExposureType = "mba_vo/ExposureStamped";

using TopicTypes = std::map<std::string, std::string>;  // topic -> type

/// Why nothing comes on an input topic, by what is published and of which type: "it is published as std_msgs/String,
/// ...". Empty if it is published as it should be.
std::string whyNothingComes(const std::string& topic, const std::string& type, const TopicTypes& published);

}  // namespace mba_vo
