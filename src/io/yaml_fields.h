#pragma once

#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace mba_vo {

/// A map in a YAML file. What is missing or malformed in it becomes a std::runtime_error that names file, line and key.
class YamlFields {
 public:
  /// `path`: of keys from the root to this map, empty for the root.
  YamlFields(std::string file, std::string path, const YAML::Node& node);

  /// A map at the root of the file. OpenCV's first line, `%YAML:1.0`, is let pass.
  static YamlFields parse(const std::string& text, const std::string& file);

  bool has(const std::string& key) const;
  std::vector<std::string> keys() const;
  YamlFields map(const std::string& key) const;
  int whole(const std::string& key) const;
  std::string text(const std::string& key) const;
  /// `allowed`: how many there must be, in words for the message; any of `counts`, empty = any number.
  std::vector<double> numbers(const std::string& key, const std::vector<std::size_t>& counts) const;
  /// Of a list of lists, row by row, each of four.
  std::vector<double> matrix4(const std::string& key) const;
  /// Throws: `key` is what it is, but must be `allowed`.
  [[noreturn]] void refuse(const std::string& key, const std::string& allowed) const;

 private:
  YAML::Node require(const std::string& key) const;
  std::string name(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

  std::string file_;
  std::string path_;
  YAML::Node node_;
};

}  // namespace mba_vo
