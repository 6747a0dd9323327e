#include "mba_vo/simulation/simulation_config.h"

#include <iomanip>
#include <sstream>
#include <stdexcept>

namespace mba_vo {
namespace {

/// Raise it with every change of the renderer, the scenes or the motion that changes images.
constexpr int kRendererVersion = 5;

struct RangeCheck {
  template <typename T>
  void operator()(const char* name, const T& value, double lowest, double highest, const char* help) const {
    const double number = static_cast<double>(value);
    if (number >= lowest && number <= highest) return;  // false for NaN
    std::ostringstream message;
    message << name << " = " << value << " is outside " << lowest << " .. " << highest << " (" << help << ")";
    throw std::invalid_argument(message.str());
  }
  template <typename T>
  void operator()(const char*, const T&, const char*) const {}
};

struct FingerprintWriter {
  std::ostringstream text;

  template <typename T>
  void operator()(const char* name, const T& value, double, double, const char*) {
    text << name << '=' << value << '\n';
  }
  void operator()(const char* name, const std::string& value, const char*) { text << name << '=' << value << '\n'; }
  void operator()(const char* name, const std::vector<double>& values, const char*) {
    text << name << '=';
    for (const double value : values) text << value << ' ';
    text << '\n';
  }
  void operator()(const char*, bool, const char*) {}  // which images a frame carries does not change them
};

void checkDistortion(const std::string& model, const std::vector<double>& coefficients) {
  const std::size_t count = coefficients.size();
  const auto fail = [&](const std::string& allowed) {
    throw std::invalid_argument("distortion: " + model + " takes " + allowed + " coefficients, got " +
                                std::to_string(count));
  };
  if (model == "plumb_bob") {
    if (count != 0 && count != 4 && count != 5) fail("0, 4 or 5");
  } else if (model == "rational_polynomial") {
    if (count != 0 && count != 8) fail("0 or 8");
  } else if (model == "equidistant") {
    if (count != 4) fail("4");
  } else {
    throw std::invalid_argument("distortion_model = '" + model +
                                "' is none of plumb_bob, rational_polynomial, equidistant");
  }
}

}  // namespace

void SimulationConfig::validate() const {
  RangeCheck check;
  describe(*this, check);
  checkDistortion(distortion_model, distortion);
  if (exposure * rate > 1.0) {
    throw std::invalid_argument("exposure = " + std::to_string(exposure) + " s is longer than the frame interval of " +
                                std::to_string(1.0 / rate) + " s");
  }
  if (row_time * (height - 1) * rate > 1.0) {
    throw std::invalid_argument("row_time = " + std::to_string(row_time) + " s: reading " + std::to_string(height) +
                                " rows takes longer than the frame interval of " + std::to_string(1.0 / rate) + " s");
  }
}

void SimulationConfig::resize(int new_width, int new_height) {
  const PinholeCamera old = camera();
  const double sx = static_cast<double>(new_width) / width;
  const double sy = static_cast<double>(new_height) / height;
  width = new_width;
  height = new_height;
  fx = sx * old.fx;
  fy = sy * old.fy;
  cx = sx * (old.cx + 0.5) - 0.5;  // pixel centres are at integers
  cy = sy * (old.cy + 0.5) - 0.5;
}

CameraCalibration SimulationConfig::calibration() const {
  const PinholeCamera c = camera();
  return {c.width, c.height, c.fx, c.fy, c.cx, c.cy, distortion_model, distortion};
}

PinholeCamera SimulationConfig::camera() const {
  return {
      width, height, fx, fy > 0.0 ? fy : fx, cx >= 0.0 ? cx : 0.5 * (width - 1), cy >= 0.0 ? cy : 0.5 * (height - 1)};
}

std::string SimulationConfig::fingerprint() const {
  FingerprintWriter writer;
  writer.text << std::setprecision(17) << "renderer_version=" << kRendererVersion << '\n';
  describe(*this, writer);
  return writer.text.str();
}

}  // namespace mba_vo
