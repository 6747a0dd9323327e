#include "mba_vo/simulation/simulation_config.h"

#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "mba_vo/simulation/motion_piece.h"

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
  void operator()(const char* name, bool value, const char*) { text << name << '=' << value << '\n'; }
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
  } else if (model == "fov") {
    if (count != 1) fail("1");
  } else {
    throw std::invalid_argument("distortion_model = '" + model +
                                "' is none of plumb_bob, rational_polynomial, equidistant, fov");
  }
}

}  // namespace

void SimulationConfig::validate() const {
  RangeCheck check;
  describe(*this, check);
  checkDistortion(distortion_model, distortion);
  checkMotion();
  checkExposures();
  if (row_time * (height - 1) * rate > 1.0) {
    throw std::invalid_argument("row_time = " + std::to_string(row_time) + " s: reading " + std::to_string(height) +
                                " rows takes longer than the frame interval of " + std::to_string(1.0 / rate) + " s");
  }
}

void SimulationConfig::checkMotion() const {
  if (!motion.empty()) return;
  if (duration == 0.0) throw std::invalid_argument("duration = 0 has a meaning only with a recorded motion");
  if (start > 0.0) throw std::invalid_argument("start = " + std::to_string(start) + " s: there is no recorded motion");
}

void SimulationConfig::checkExposures() const {
  const double longest = longestExposure();
  if (longest * rate > 1.0) {
    throw std::invalid_argument((exposure_max > 0.0 ? "exposure_max = " : "exposure = ") + std::to_string(longest) +
                                " s is longer than the frame interval of " + std::to_string(1.0 / rate) + " s");
  }
  const bool varies = exposure_min > 0.0 || exposure_max > 0.0;
  if (varies && (exposure_min <= 0.0 || exposure_min > exposure_max)) {
    throw std::invalid_argument("exposure_min = " + std::to_string(exposure_min) + " s must be above 0 and at most " +
                                "exposure_max = " + std::to_string(exposure_max) + " s");
  }
  if (varies && exposure <= 0.0) {
    throw std::invalid_argument("exposure = 0: exposures that vary need one at which the image has its brightness");
  }
  if (gain_error > 0.0 && !auto_gain) {
    throw std::invalid_argument("gain_error = " + std::to_string(gain_error) + " needs auto_gain");
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

CameraCalibration SimulationConfig::toldCalibration() const {
  CameraCalibration told = calibration();
  told.fx *= 1.0 + calibration_focal_error;
  told.fy *= 1.0 + calibration_focal_error;
  told.cx += calibration_centre_error;
  told.cy += calibration_centre_error;
  return told;
}

std::string SimulationConfig::fingerprint() const {
  FingerprintWriter writer;
  writer.text << std::setprecision(17) << "renderer_version=" << kRendererVersion << '\n';
  describeScene(*this, writer);
  // Younger options count only where they are used, so that images from before them stay known.
  SimulationConfig recording = *this;
  recording.motion.clear();  // the poses count, not the name
  const auto lines = [](const SimulationConfig& config) {
    FingerprintWriter part;
    part.text << std::setprecision(17);
    describeRecording(config, part);
    return part.text.str();
  };
  const std::string used = lines(recording);
  if (used != lines({})) writer.text << used;
  if (!motion.empty()) writer.text << "motion=" << std::hex << MotionPiece(*this).hash() << '\n';
  return writer.text.str();
}

}  // namespace mba_vo
