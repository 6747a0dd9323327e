#pragma once

#include <ostream>
#include <set>
#include <string>

#include <yaml-cpp/yaml.h>

#include "mba_vo/odometry/config.h"

namespace mba_vo {

/// Visitor that sets the options of a `describe`d struct from a YAML map; options not in the map keep their values.
/// Throws std::invalid_argument naming the option, its value and what is allowed. Use readConfig() below.
class YamlConfigReader {
 public:
  /// `path` names the section in messages, "" at the top.
  YamlConfigReader(const YAML::Node& node, const std::string& path);

  template <typename Number, typename Bound>
  void operator()(const char* key, Number& field, Bound min, Bound max, const char* /*doc*/) {
    if (take(key)) {
      Number value{};
      read(key, value);
      checkRange(key, static_cast<double>(value), static_cast<double>(min), static_cast<double>(max));
      field = value;
    }
  }
  template <typename Value>
  void operator()(const char* key, Value& field, const char* /*doc*/) {
    if (take(key)) {
      read(key, field);
    }
  }
  template <typename Nested>
  void section(const char* key, Nested& nested) {
    const bool given = take(key);
    YamlConfigReader reader(given ? node_[key] : YAML::Node(), pathOf(key));
    Nested::describe(nested, reader);
    reader.finish();
  }

  /// Throws if the map has a key that was not asked for.
  void finish() const;

 private:
  bool take(const char* key);
  std::string pathOf(const std::string& key) const;
  void read(const char* key, int& value) const;
  void read(const char* key, double& value) const;
  void read(const char* key, bool& value) const;
  void read(const char* key, std::string& value) const;
  void checkRange(const char* key, double value, double min, double max) const;

  const YAML::Node node_;
  std::string path_;
  std::set<std::string> allowed_;
};

/// Visitor that writes the options of a `describe`d struct as YAML, each with its meaning and range as a comment.
class YamlConfigWriter {
 public:
  explicit YamlConfigWriter(std::ostream& out, int depth = 0) : out_(out), depth_(depth) {}

  template <typename Number, typename Bound>
  void operator()(const char* key, const Number& field, Bound min, Bound max, const char* doc) {
    line(key, format(field), std::string(doc) + " (" + format(Number(min)) + " to " + format(Number(max)) + ")");
  }
  template <typename Value>
  void operator()(const char* key, const Value& field, const char* doc) {
    line(key, format(field), doc);
  }
  template <typename Nested>
  void section(const char* key, const Nested& nested) {
    beginSection(key);
    YamlConfigWriter writer(out_, depth_ + 1);
    Nested::describe(nested, writer);
  }

 private:
  static std::string format(int value);
  static std::string format(double value);
  static std::string format(bool value);
  static std::string format(const std::string& value);
  void line(const std::string& key, const std::string& value, const std::string& comment);
  void beginSection(const std::string& key);

  std::ostream& out_;
  int depth_;
};

/// Sets the options of any `describe`d struct from a YAML map (null = no option given).
template <typename Config>
void readConfig(const YAML::Node& node, Config& config) {
  YamlConfigReader reader(node, "");
  Config::describe(config, reader);
  reader.finish();
}

/// Writes the options of any `describe`d struct.
template <typename Config>
void writeConfig(const Config& config, std::ostream& out) {
  YamlConfigWriter writer(out);
  Config::describe(config, writer);
}

/// Fills what follows from other options: the mapper tracks with the tracker's options. Call after changing any option.
void finalize(OdometryConfig& config);

/// readConfig, then finalize.
void applyYaml(const YAML::Node& node, OdometryConfig& config);

/// Throws std::runtime_error naming the file if it cannot be read or parsed.
YAML::Node loadYamlFile(const std::string& file);

/// Changes the options of any `describe`d struct by a YAML file. Throws std::runtime_error naming the file, and the
/// option if one is wrong.
template <typename Config>
void loadYaml(const std::string& file, Config& config) {
  const YAML::Node node = loadYamlFile(file);
  try {
    readConfig(node, config);
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(file + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

/// The defaults changed by the YAML file. Throws std::runtime_error naming the file if it cannot be read or parsed, or
/// the option that is wrong.
OdometryConfig loadConfig(const std::string& file);

}  // namespace mba_vo
