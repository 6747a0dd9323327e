#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "camera_forms.h"
#include "mba_vo/io/text_lines.h"

namespace mba_vo {
namespace {

/// A kind of lens in camera.txt.
struct Lens {
  const char* name;
  std::size_t coefficients;
  const char* model;  // ours
};

constexpr std::array<Lens, 5> kLenses{{{"FOV", 1, "fov"},
                                       {"Pinhole", 1, ""},
                                       {"RadTan", 4, "plumb_bob"},
                                       {"EquiDistant", 4, "equidistant"},
                                       {"KannalaBrandt", 4, "equidistant"}}};
constexpr std::size_t kPinholeValues = 4;  // fx fy cx cy

/// The lens of the first line. A line without a name has 5 values (FOV) or 8 (RadTan).
Lens lensOf(const TextLine& line) {
  if (!beginsNumber(line.words.front())) {
    for (const Lens& lens : kLenses) {
      if (line.words.front() == lens.name) return lens;
    }
    throw std::runtime_error(line.where + ": camera model '" + line.words.front() +
                             "', must be FOV, Pinhole, RadTan, EquiDistant, KannalaBrandt or none");
  }
  if (line.words.size() == kPinholeValues + 1) return kLenses[0];
  if (line.words.size() == kPinholeValues + 4) return kLenses[2];
  throw std::runtime_error(line.where + ": " + std::to_string(line.words.size()) +
                           " values without a camera model; 4 (fx fy cx cy), 5 (FOV) or 8 (RadTan) are allowed");
}

std::vector<double> valuesOf(const TextLine& line, const Lens& lens) {
  std::vector<double> values;
  const std::size_t first = beginsNumber(line.words.front()) ? 0 : 1;
  for (std::size_t i = first; i < line.words.size(); ++i) {
    values.push_back(parseFinite(line.words[i], "value", line.where));
  }
  if (values.size() != kPinholeValues + lens.coefficients) {
    throw std::runtime_error(line.where + ": " + lens.name + " has " + std::to_string(values.size()) +
                             " values, must have " + std::to_string(kPinholeValues + lens.coefficients));
  }
  if (*lens.model == '\0' && values.back() != 0.0) {
    throw std::runtime_error(line.where + ": the fifth value of Pinhole is " + line.words.back() + ", must be 0");
  }
  return values;
}

cv::Size sizeOf(const TextLine& line) {
  const auto side = [&](std::size_t i) {
    constexpr std::uint64_t kLargest = 100000;  // [px]
    const std::uint64_t value = parseWhole(line.words[i], i == 0 ? "width" : "height", line.where);
    if (value < 2 || value > kLargest) {
      throw std::runtime_error(line.where + ": side of " + std::to_string(value) + " px, must be 2 to 100000");
    }
    return static_cast<int>(value);
  };
  if (line.words.size() != 2) {
    throw std::runtime_error(line.where + ": " + std::to_string(line.words.size()) +
                             " words; width and height of the images are allowed");
  }
  return {side(0), side(1)};
}

/// What the images are to be rectified to. We choose that ourselves; but a line that is something else shows that the
/// file is not what it seems.
void checkRectification(const TextLine& line) {
  const std::string& word = line.words.front();
  if (line.words.size() == 1 && (word == "crop" || word == "full" || word == "none")) return;
  if (line.words.size() != kPinholeValues && line.words.size() != kPinholeValues + 1) {
    throw std::runtime_error(line.where + ": '" + word + "': crop, full, none or 'fx fy cx cy 0' are allowed");
  }
  for (const std::string& value : line.words) parseFinite(value, "value", line.where);
}

/// A principal point below 1 says that all four are relative to the sides of the image, whose first pixel then begins
/// at 0; with us its centre is there.
void setPinhole(const std::vector<double>& v, const std::string& where, CameraCalibration& c) {
  constexpr double kLongest = 50.0;  // focal length relative to the image: a lens of 1 degree
  const bool relative = v[2] < 1.0 && v[3] < 1.0;
  const auto [least, most] = std::minmax_element(v.begin(), v.begin() + kPinholeValues);
  if (relative ? *most > kLongest : *least < 1.0) {
    throw std::runtime_error(where +
                             ": fx fy cx cy must all be in pixels, or all relative to the image (cx, cy below 1)");
  }
  c.fx = relative ? c.width * v[0] : v[0];
  c.fy = relative ? c.height * v[1] : v[1];
  c.cx = relative ? c.width * v[2] - 0.5 : v[2];
  c.cy = relative ? c.height * v[3] - 0.5 : v[3];
}

CameraFile readFourNumbers(const TextLine& line, cv::Size size) {
  if (size.empty()) {
    throw std::runtime_error(line.where +
                             ": fx fy cx cy without the size of the image; "
                             "such a file is good only for a folder of images");
  }
  std::vector<double> v;
  for (const std::string& word : line.words) v.push_back(parseFinite(word, "value", line.where));
  CameraFile result{{size.width, size.height, v[0], v[1], v[2], v[3], "", {}}, "fx fy cx cy", {}};
  requireValid(result.calibration, line.where);
  return result;
}

}  // namespace

CameraFile readCameraText(const std::string& text, const std::string& file, cv::Size image_size) {
  const std::vector<TextLine> lines = splitLines(text, file);
  const TextLine& first = lines.front();
  if (lines.size() == 1 && first.words.size() == kPinholeValues && beginsNumber(first.words.front())) {
    return readFourNumbers(first, image_size);
  }
  const Lens lens = lensOf(first);
  const std::vector<double> values = valuesOf(first, lens);
  if (lines.size() < 2)
    throw std::runtime_error(file + ": the second line, width and height of the images, is missing");
  const cv::Size size = sizeOf(lines[1]);
  if (lines.size() > 2) checkRectification(lines[2]);
  if (lines.size() > 3) sizeOf(lines[3]);
  CameraFile result;
  result.form = std::string("camera.txt, ") + lens.name;
  CameraCalibration& c = result.calibration;
  c = {size.width, size.height, 0.0, 0.0, 0.0, 0.0, lens.model, {}};
  if (!c.distortion_model.empty()) c.distortion.assign(values.begin() + kPinholeValues, values.end());
  setPinhole(values, first.where, c);
  requireValid(c, first.where);
  return result;
}

}  // namespace mba_vo
