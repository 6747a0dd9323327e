#include "mba_vo/ros/node_config.h"

#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include <XmlRpcValue.h>

#include "mba_vo/odometry/config_yaml.h"

namespace mba_vo {
namespace {

/// Sub-namespaces of nodes, not of options.
const std::set<std::string>& foreignNamespaces() {
  static const std::set<std::string> kNames = {"manager", "tracking", "mapping", "player", "exposure_relay"};
  return kNames;
}

/// Visitor that collects the names at the top of a described struct.
struct KeyCollector {
  std::set<std::string> keys;
  template <typename Value, typename... Rest>
  void operator()(const char* key, Value&, Rest...) {
    keys.insert(key);
  }
  template <typename Nested>
  void section(const char* key, Nested&) {
    keys.insert(key);
  }
};

std::set<std::string> knownKeys() {
  NodeConfig config;
  KeyCollector collector;
  NodeConfig::describe(config, collector);
  return collector.keys;
}

/// TF takes no empty names and none that begin with a slash, and a frame has one parent.
void checkFrames(const FrameNames& frames) {
  const std::pair<const char*, const std::string&> named[] = {{"map_frame", frames.map_frame},
                                                              {"odom_frame", frames.odom_frame},
                                                              {"base_frame", frames.base_frame},
                                                              {"exposure_start_frame", frames.exposure_start_frame},
                                                              {"exposure_end_frame", frames.exposure_end_frame}};
  std::map<std::string, std::string> keys;  // by the name of the frame
  for (const auto& [key, frame] : named) {
    if (frame.empty() || frame.front() == '/') {
      throw std::invalid_argument(std::string(key) + " is '" + frame +
                                  "'; allowed: names that are not empty and do not begin with '/'");
    }
    const auto [other, is_new] = keys.emplace(frame, key);
    if (!is_new) {
      throw std::invalid_argument(std::string(key) + " is '" + frame + "', as " + other->second +
                                  "; allowed: a name of its own for each of the five frames");
    }
  }
}

YAML::Node toYaml(XmlRpc::XmlRpcValue& value) {
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return YAML::Node(static_cast<bool>(value));
    case XmlRpc::XmlRpcValue::TypeInt:
      return YAML::Node(static_cast<int>(value));
    case XmlRpc::XmlRpcValue::TypeDouble:
      return YAML::Node(static_cast<double>(value));
    case XmlRpc::XmlRpcValue::TypeString:
      return YAML::Node(static_cast<std::string>(value));
    case XmlRpc::XmlRpcValue::TypeArray: {
      YAML::Node list(YAML::NodeType::Sequence);
      for (int i = 0; i < value.size(); ++i) {
        list.push_back(toYaml(value[i]));
      }
      return list;
    }
    case XmlRpc::XmlRpcValue::TypeStruct: {
      YAML::Node map(YAML::NodeType::Map);
      for (auto& entry : value) {
        map[entry.first] = toYaml(entry.second);
      }
      return map;
    }
    default:
      return YAML::Node();
  }
}

}  // namespace

std::optional<double> parseExposure(const std::string& key, const std::string& text) {
  if (text == "auto") {
    return std::nullopt;
  }
  double value = 0.0;
  std::size_t used = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  const bool number = used > 0 && used == text.size();
  if (number && std::isnan(value)) {
    return std::nullopt;
  }
  if (!number || value < 0.0 || value > 10.0) {
    throw std::invalid_argument(key + " is '" + text +
                                "'; allowed: auto, nan, or seconds (not milli- or microseconds) from 0 "
                                "(instantaneous) to 10");
  }
  return value;
}

std::optional<double> NodeConfig::fixedExposure() const { return parseExposure("exposure_time", exposure_time); }

NodeConfig parseNodeConfig(const YAML::Node& parameters) {
  NodeConfig config;
  readConfig(parameters, config);
  finalize(config.odometry);
  config.stampReference();
  checkFrames(config.frames);
  // An exposure that is set for all images is not to be corrected.
  if (config.fixedExposure()) config.odometry.tracker.estimate_exposure = false;
  return config;
}

YAML::Node readParameters(const ros::NodeHandle& nh) {
  YAML::Node parameters(YAML::NodeType::Map);
  XmlRpc::XmlRpcValue tree;
  if (!nh.getParam(nh.getNamespace(), tree) || tree.getType() != XmlRpc::XmlRpcValue::TypeStruct) {
    return parameters;
  }
  const bool global = nh.getNamespace().empty() || nh.getNamespace() == "/";
  const std::set<std::string> known = knownKeys();
  for (auto& entry : tree) {
    if (global ? known.count(entry.first) > 0 : foreignNamespaces().count(entry.first) == 0) {
      parameters[entry.first] = toYaml(entry.second);
    }
  }
  return parameters;
}

}  // namespace mba_vo
