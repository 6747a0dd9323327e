#include "yaml_fields.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace mba_vo {
namespace {

constexpr std::size_t kLongestValue = 60;  // of a value in a message [characters]

std::string shown(const YAML::Node& node) {
  std::ostringstream text;
  YAML::Emitter emitter(text);
  emitter << YAML::Flow << node;
  std::string value = text.str();
  std::replace(value.begin(), value.end(), '\n', ' ');
  return value.size() > kLongestValue ? value.substr(0, kLongestValue) + "..." : value;
}

std::string lineOf(const YAML::Node& node) {
  return node.IsDefined() && !node.Mark().is_null() ? ":" + std::to_string(node.Mark().line + 1) : "";
}

std::string listOf(const std::vector<std::size_t>& counts) {
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const char* const separator = i == 0 ? "" : (i + 1 == counts.size() ? " or " : ", ");
    text += separator + std::to_string(counts[i]);
  }
  return text;
}

}  // namespace

YamlFields::YamlFields(std::string file, std::string path, const YAML::Node& node)
    : file_(std::move(file)), path_(std::move(path)), node_(node) {}

YamlFields YamlFields::parse(const std::string& text, const std::string& file) {
  std::string content = text;
  // OpenCV writes a directive that is none in YAML; its line is kept, so that the others keep their numbers.
  if (content.compare(0, 1, "%") == 0) content[0] = '#';
  YAML::Node root;
  try {
    root = YAML::Load(content);
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.is_null() ? "" : ":" + std::to_string(error.mark.line + 1);
    throw std::runtime_error(file + line + ": no YAML: " + error.msg);
  }
  if (!root.IsMap()) throw std::runtime_error(file + ": must be a YAML file with keys and values");
  return {file, "", root};
}

bool YamlFields::has(const std::string& key) const { return static_cast<bool>(node_[key]); }

std::vector<std::string> YamlFields::keys() const {
  std::vector<std::string> keys;
  for (const auto& field : node_) keys.push_back(field.first.IsScalar() ? field.first.Scalar() : "");
  return keys;
}

YAML::Node YamlFields::require(const std::string& key) const {
  if (!has(key)) throw std::runtime_error(file_ + lineOf(node_) + ": '" + name(key) + "' is missing");
  return node_[key];
}

void YamlFields::refuse(const std::string& key, const std::string& allowed) const {
  const YAML::Node value = require(key);
  throw std::runtime_error(file_ + lineOf(value) + ": '" + name(key) + "' is " + shown(value) + ", must be " + allowed);
}

YamlFields YamlFields::map(const std::string& key) const {
  const YAML::Node value = require(key);
  if (!value.IsMap()) refuse(key, "a map of keys and values");
  return {file_, name(key), value};
}

int YamlFields::whole(const std::string& key) const {
  try {
    return require(key).as<int>();
  } catch (const YAML::Exception&) {
    refuse(key, "a whole number");
  }
}

std::string YamlFields::text(const std::string& key) const {
  if (!require(key).IsScalar()) refuse(key, "a word");
  return require(key).Scalar();
}

std::vector<double> YamlFields::numbers(const std::string& key, const std::vector<std::size_t>& counts) const {
  std::vector<double> values;
  try {
    values = require(key).as<std::vector<double>>();
  } catch (const YAML::Exception&) {
    refuse(key, "a list of numbers");
  }
  for (const double value : values) {
    if (!std::isfinite(value)) refuse(key, "a list of finite numbers");
  }
  if (!counts.empty() && std::find(counts.begin(), counts.end(), values.size()) == counts.end()) {
    refuse(key, "a list of " + listOf(counts) + " numbers, has " + std::to_string(values.size()));
  }
  return values;
}

std::vector<double> YamlFields::matrix4(const std::string& key) const {
  constexpr std::size_t kRows = 4;
  std::vector<std::vector<double>> rows;
  try {
    rows = require(key).as<std::vector<std::vector<double>>>();
  } catch (const YAML::Exception&) {
    refuse(key, "4 lists of 4 numbers");
  }
  std::vector<double> values;
  for (const std::vector<double>& row : rows) {
    if (rows.size() != kRows || row.size() != kRows) refuse(key, "4 lists of 4 numbers");
    values.insert(values.end(), row.begin(), row.end());
  }
  if (values.empty()) refuse(key, "4 lists of 4 numbers");
  return values;
}

}  // namespace mba_vo
