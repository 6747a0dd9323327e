#include "mba_vo/datasets/foreign_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace mba_vo {
namespace {

constexpr std::size_t kCoefficients = 4;  // k1 k2 p1 p2, or k1 to k4

enum class Lens { kPinhole, kRadialTangential, kEquidistant, kFov, kOther };

Lens lensOf(const CameraCalibration& c) {
  if (isUndistorted(c)) return Lens::kPinhole;
  if (c.distortion_model == "plumb_bob") return Lens::kRadialTangential;
  if (c.distortion_model == "equidistant") return Lens::kEquidistant;
  if (c.distortion_model == "fov") return Lens::kFov;
  return Lens::kOther;
}

/// A third radial coefficient, which most files have no place for.
double thirdRadial(const CameraCalibration& c) {
  return c.distortion.size() > kCoefficients ? c.distortion[kCoefficients] : 0.0;
}

[[noreturn]] void refuse(const CameraCalibration& c, const std::string& reader, const std::string& allowed) {
  const bool third = lensOf(c) == Lens::kRadialTangential;
  const std::string lens = c.distortion_model + (third ? " with k3 = " + std::to_string(thirdRadial(c)) : "");
  throw std::invalid_argument("lens " + lens + ": " + reader + " knows no such; " + allowed +
                              " are allowed, or rectify the images");
}

std::vector<double> firstCoefficients(const CameraCalibration& c, std::size_t count) {
  std::vector<double> values = c.distortion;
  values.resize(count, 0.0);
  return values;
}

std::string joined(const std::vector<double>& values, const char* separator) {
  std::ostringstream text;
  text << std::setprecision(std::numeric_limits<double>::max_digits10);
  for (std::size_t i = 0; i < values.size(); ++i) text << (i > 0 ? separator : "") << values[i];
  return text.str();
}

/// A number that OpenCV's reader takes for a real one: it is particular about whole numbers.
std::string real(double value) {
  const std::string text = joined({value}, "");
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

struct Value {
  const char* key;
  double value;
};

void writeReals(const std::vector<Value>& values, const std::string& prefix, std::ostream& out) {
  for (const auto& [key, value] : values) out << prefix << key << ": " << real(value) << "\n";
}

std::vector<Value> intrinsics(const CameraCalibration& c) {
  return {{"fx", c.fx}, {"fy", c.fy}, {"cx", c.cx}, {"cy", c.cy}};
}

std::vector<Value> orbSlamDistortion(const CameraCalibration& c) {
  std::vector<Value> values;
  const bool equidistant = lensOf(c) == Lens::kEquidistant;
  const std::array<const char*, kCoefficients> names =
      equidistant ? std::array<const char*, kCoefficients>{"k1", "k2", "k3", "k4"}
                  : std::array<const char*, kCoefficients>{"k1", "k2", "p1", "p2"};
  const std::vector<double> d = firstCoefficients(c, kCoefficients);
  for (std::size_t i = 0; i < names.size(); ++i) values.push_back({names[i], d[i]});
  if (!equidistant && thirdRadial(c) != 0.0) values.push_back({"k3", thirdRadial(c)});
  return values;
}

}  // namespace

void writeDsoCamera(const CameraCalibration& c, std::ostream& out) {
  const Lens lens = lensOf(c);
  const bool too_many = lens == Lens::kRadialTangential && thirdRadial(c) != 0.0;
  if (lens == Lens::kOther || too_many) refuse(c, "DSO", "plumb_bob without k3, equidistant, fov and no distortion");
  std::vector<double> values{c.fx, c.fy, c.cx, c.cy};
  const auto line = [&](const char* name, std::size_t coefficients) {
    for (const double value : firstCoefficients(c, coefficients)) values.push_back(value);
    out << name << " " << joined(values, " ") << "\n";
  };
  if (lens == Lens::kPinhole) {
    values.push_back(0.0);
    out << "Pinhole " << joined(values, " ") << "\n";
  }
  if (lens == Lens::kRadialTangential) line("RadTan", kCoefficients);
  if (lens == Lens::kEquidistant) line("EquiDistant", 4);
  if (lens == Lens::kFov) line("FOV", 1);
  constexpr int kMultiple = 16;  // four halvings
  const int width = c.width / kMultiple * kMultiple;
  const int height = c.height / kMultiple * kMultiple;
  const bool as_it_is = lens == Lens::kPinhole && width == c.width && height == c.height;
  out << c.width << " " << c.height << "\n" << (as_it_is ? "none" : "crop") << "\n" << width << " " << height << "\n";
}

void writeAslCamera(const CameraCalibration& c, double rate, std::ostream& out) {
  const Lens lens = lensOf(c);
  const bool too_many = lens == Lens::kRadialTangential && thirdRadial(c) != 0.0;
  if (lens == Lens::kOther || lens == Lens::kFov || too_many) {
    refuse(c, "the form of EuRoC", "plumb_bob without k3, equidistant and no distortion");
  }
  // Readers of this form want a distortion even where there is none.
  out << "sensor_type: camera\ncomment: mba_vo_export\n"
      << "T_BS:\n  cols: 4\n  rows: 4\n  data: [1.0, 0.0, 0.0, 0.0,\n         0.0, 1.0, 0.0, 0.0,\n"
      << "         0.0, 0.0, 1.0, 0.0,\n         0.0, 0.0, 0.0, 1.0]\n"
      << "rate_hz: " << std::lround(rate) << "\nresolution: [" << c.width << ", " << c.height << "]\n"
      << "camera_model: pinhole\nintrinsics: [" << joined({c.fx, c.fy, c.cx, c.cy}, ", ") << "]\n"
      << "distortion_model: " << (lens == Lens::kEquidistant ? "equidistant" : "radial-tangential") << "\n"
      << "distortion_coefficients: [" << joined(firstCoefficients(c, kCoefficients), ", ") << "]\n";
}

void writeOrbSlamSettings(const CameraCalibration& c, double rate, std::ostream& out) {
  const Lens lens = lensOf(c);
  if (lens == Lens::kOther || lens == Lens::kFov) refuse(c, "ORB-SLAM", "plumb_bob, equidistant and no distortion");
  const bool fisheye = lens == Lens::kEquidistant;
  out << "%YAML:1.0\n# Of mba_vo_export. Keys Camera1 and File are of ORB-SLAM3.\nFile.version: \"1.0\"\n"
      << "Camera.type: \"" << (fisheye ? "KannalaBrandt8" : "PinHole") << "\"\n";
  writeReals(intrinsics(c), "Camera1.", out);
  if (lens != Lens::kPinhole) writeReals(orbSlamDistortion(c), "Camera1.", out);
  if (!fisheye) {
    writeReals(intrinsics(c), "Camera.", out);
    writeReals(orbSlamDistortion(c), "Camera.", out);  // zeros for a pinhole: ORB-SLAM2 demands them
  }
  // Colour images come from OpenCV, which has blue first.
  out << "Camera.width: " << c.width << "\nCamera.height: " << c.height
      << "\nCamera.fps: " << std::max(1L, std::lround(rate)) << "\nCamera.RGB: 0\n"
      << "ORBextractor.nFeatures: 1000\nORBextractor.nLevels: 8\nORBextractor.iniThFAST: 20\n"
      << "ORBextractor.minThFAST: 7\n";
  writeReals({{"ORBextractor.scaleFactor", 1.2},
              {"Viewer.KeyFrameSize", 0.05},
              {"Viewer.KeyFrameLineWidth", 1.0},
              {"Viewer.GraphLineWidth", 0.9},
              {"Viewer.PointSize", 2.0},
              {"Viewer.CameraSize", 0.08},
              {"Viewer.CameraLineWidth", 3.0},
              {"Viewer.ViewpointX", 0.0},
              {"Viewer.ViewpointY", -0.7},
              {"Viewer.ViewpointZ", -1.8},
              {"Viewer.ViewpointF", 500.0}},
             "", out);
}

}  // namespace mba_vo
