#include <algorithm>
#include <stdexcept>
#include <vector>

#include "camera_forms.h"
#include "mba_vo/io/text_lines.h"

namespace mba_vo {
namespace {

/// Numbers below each heading of an INI file.
struct Heading {
  std::string name;
  std::string where;
  std::vector<double> values;
};

std::vector<Heading> headings(const std::string& text, const std::string& file) {
  std::vector<Heading> result;
  for (const TextLine& line : splitLines(text, file)) {
    const std::string& first = line.words.front();
    if (first.front() == '[') continue;
    if (!beginsNumber(first)) {
      result.push_back({joinWords(line.words, " "), line.where, {}});
      continue;
    }
    if (result.empty()) throw std::runtime_error(line.where + ": '" + first + "' stands below no heading");
    for (const std::string& word : line.words) {
      result.back().values.push_back(parseFinite(word, result.back().name, line.where));
    }
  }
  return result;
}

std::vector<double> valuesBelow(const std::vector<Heading>& all, const std::string& name,
                                const std::vector<std::size_t>& counts, const std::string& file) {
  for (const Heading& heading : all) {
    if (heading.name != name) continue;
    if (std::find(counts.begin(), counts.end(), heading.values.size()) != counts.end()) return heading.values;
    std::string allowed;
    for (const std::size_t count : counts) allowed += (allowed.empty() ? "" : " or ") + std::to_string(count);
    throw std::runtime_error(heading.where + ": '" + name + "' has " + std::to_string(heading.values.size()) +
                             " numbers, must have " + allowed);
  }
  throw std::runtime_error(file + ": '" + name + "' is missing");
}

int sideBelow(const std::vector<Heading>& all, const std::string& name, const std::string& file) {
  const double side = valuesBelow(all, name, {1}, file).front();
  constexpr double kLargest = 1e5;  // [px]
  if (side >= 2.0 && side <= kLargest && side == static_cast<int>(side)) return static_cast<int>(side);
  throw std::runtime_error(file + ": '" + name + "' is " + std::to_string(side) + ", must be 2 to 100000, whole");
}

}  // namespace

CameraFile readCameraIni(const std::string& text, const std::string& file) {
  const std::vector<Heading> all = headings(text, file);
  CameraFile result;
  result.form = "ROS camera_info (INI)";
  result.of_ros = true;
  CameraCalibration& c = result.calibration;
  c.width = sideBelow(all, "width", file);
  c.height = sideBelow(all, "height", file);
  const std::vector<double> K = valuesBelow(all, "camera matrix", {9}, file);
  c.fx = K[0];
  c.cx = K[2];
  c.fy = K[4];
  c.cy = K[5];
  c.distortion = valuesBelow(all, "distortion", {4, 5, 8}, file);
  c.distortion_model = c.distortion.size() == 8 ? "rational_polynomial" : "plumb_bob";
  requireValid(c, file);
  return result;
}

}  // namespace mba_vo
