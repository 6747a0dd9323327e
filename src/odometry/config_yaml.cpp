#include "mba_vo/odometry/config_yaml.h"

#include <array>
#include <charconv>
#include <stdexcept>

namespace mba_vo {
namespace {

std::string describeNode(const YAML::Node& node) {
  return node.IsScalar()     ? "'" + node.Scalar() + "'"
         : node.IsSequence() ? "a list"
         : node.IsMap()      ? "a map"
                             : "nothing";
}

template <typename Value>
void convert(const YAML::Node& node, const std::string& path, const char* wanted, Value& value) {
  try {
    if (!node.IsScalar()) {
      throw YAML::BadConversion(node.Mark());
    }
    value = node.as<Value>();
  } catch (const YAML::Exception&) {
    throw std::invalid_argument("option '" + path + "': " + describeNode(node) + " given, must be " + wanted);
  }
}

/// Fewest characters that read back as the same number.
std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() ? std::string(text.data(), end) : std::to_string(value);
}

}  // namespace

YamlConfigReader::YamlConfigReader(const YAML::Node& node, const std::string& path) : node_(node), path_(path) {
  if (node_.IsDefined() && !node_.IsNull() && !node_.IsMap()) {
    const std::string name = path.empty() ? "configuration" : "section '" + path + "'";
    throw std::invalid_argument(name + ": " + describeNode(node_) + " given, must be a map of options");
  }
}

bool YamlConfigReader::take(const char* key) {
  allowed_.insert(key);
  return node_.IsMap() && node_[key].IsDefined();
}

std::string YamlConfigReader::pathOf(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

void YamlConfigReader::read(const char* key, int& value) const {
  convert(node_[key], pathOf(key), "a whole number", value);
}

void YamlConfigReader::read(const char* key, double& value) const {
  convert(node_[key], pathOf(key), "a number", value);
}

void YamlConfigReader::read(const char* key, bool& value) const {
  convert(node_[key], pathOf(key), "true or false", value);
}

void YamlConfigReader::read(const char* key, std::string& value) const {
  convert(node_[key], pathOf(key), "a text", value);
}

void YamlConfigReader::checkRange(const char* key, double value, double min, double max) const {
  if (!(value >= min && value <= max)) {  // false for NaN too
    throw std::invalid_argument("option '" + pathOf(key) + "': " + shortest(value) + " is out of range, must be " +
                                shortest(min) + " to " + shortest(max));
  }
}

void YamlConfigReader::finish() const {
  if (!node_.IsMap()) {
    return;
  }
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : describeNode(entry.first);
    if (allowed_.count(key) == 0) {
      std::string list;
      for (const std::string& name : allowed_) {
        list += (list.empty() ? "" : ", ") + name;
      }
      throw std::invalid_argument("unknown option '" + pathOf(key) + "'; allowed are: " + list);
    }
    if (!seen.insert(key).second) {
      throw std::invalid_argument("option '" + pathOf(key) + "' is given twice");
    }
  }
}

std::string YamlConfigWriter::format(int value) { return std::to_string(value); }

std::string YamlConfigWriter::format(double value) { return shortest(value); }

std::string YamlConfigWriter::format(bool value) { return value ? "true" : "false"; }

std::string YamlConfigWriter::format(const std::string& value) {
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << value;
  return emitter.c_str();
}

void YamlConfigWriter::line(const std::string& key, const std::string& value, const std::string& comment) {
  out_ << std::string(static_cast<std::size_t>(2 * depth_), ' ') << key << ": " << value << "  # " << comment << "\n";
}

void YamlConfigWriter::beginSection(const std::string& key) {
  out_ << std::string(static_cast<std::size_t>(2 * depth_), ' ') << key << ":\n";
}

void finalize(OdometryConfig& config) {
  config.mapper.tracker = config.tracker;
  config.mapper.keyframe = config.keyframe;
  config.mapper.vignette_told = !config.image.vignette_file.empty();
}

void applyYaml(const YAML::Node& node, OdometryConfig& config) {
  readConfig(node, config);
  finalize(config);
}

OdometryConfig loadConfig(const std::string& file) {
  OdometryConfig config;
  loadYaml(file, config);
  finalize(config);
  return config;
}

YAML::Node loadYamlFile(const std::string& file) {
  try {
    return YAML::LoadFile(file);
  } catch (const YAML::BadFile&) {
    throw std::runtime_error(file + ": cannot be read");
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

}  // namespace mba_vo
