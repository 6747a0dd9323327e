#include "mba_vo/image/camera_calibration.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace mba_vo {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;  // [rad]

template <typename Value>
[[noreturn]] void fail(const char* name, const Value& value, const char* allowed) {
  std::ostringstream message;
  message << "camera calibration: " << name << " is " << value << ", must be " << allowed;
  throw std::invalid_argument(message.str());
}

void requireSize(const char* name, int value) {
  if (value < 2) fail(name, value, "at least 2 px");
}

void requirePositive(const char* name, double value) {
  if (!(value > 0.0 && std::isfinite(value))) fail(name, value, "greater than 0");
}

bool allZero(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return v == 0.0; });
}

void validateDistortion(const CameraCalibration& c) {
  const std::size_t n = c.distortion.size();
  if (c.distortion_model.empty()) {
    if (!allZero(c.distortion)) fail("distortion model", "empty", "named when there are distortion coefficients");
  } else if (c.distortion_model == "plumb_bob") {
    if (n != 0 && n != 4 && n != 5) fail("number of plumb_bob coefficients", n, "4 or 5 (0 = undistorted)");
  } else if (c.distortion_model == "rational_polynomial") {
    if (n != 8) fail("number of rational_polynomial coefficients", n, "8");
  } else if (c.distortion_model == "equidistant") {
    if (n != 4) fail("number of equidistant coefficients", n, "4");
  } else if (c.distortion_model == "fov") {
    if (n != 1) fail("number of fov coefficients", n, "1");
    if (!(c.distortion[0] >= 0.0 && c.distortion[0] < kHalfTurn)) fail("omega", c.distortion[0], "from 0 to below pi");
  } else {
    fail("distortion model", "'" + c.distortion_model + "'",
         "plumb_bob, rational_polynomial, equidistant, fov or empty (undistorted)");
  }
  for (const double d : c.distortion) {
    if (!std::isfinite(d)) fail("a distortion coefficient", d, "finite");
  }
}

}  // namespace

void validate(const CameraCalibration& calibration) {
  requireSize("width", calibration.width);
  requireSize("height", calibration.height);
  requirePositive("fx", calibration.fx);
  requirePositive("fy", calibration.fy);
  if (!std::isfinite(calibration.cx)) fail("cx", calibration.cx, "finite");
  if (!std::isfinite(calibration.cy)) fail("cy", calibration.cy, "finite");
  validateDistortion(calibration);
}

bool isUndistorted(const CameraCalibration& calibration) {
  // The equidistant model differs from a pinhole even with all coefficients zero.
  return calibration.distortion_model != "equidistant" && allZero(calibration.distortion);
}

}  // namespace mba_vo
