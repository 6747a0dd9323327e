#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "mba_vo/inspection/judgements.h"
#include "wording.h"

#include "mba_vo/geometry/angles.h"

namespace mba_vo {
namespace {

constexpr double kNarrowest = 15.0;    // [degrees] of view, without the distortion
constexpr double kWidest = 150.0;      // the same
constexpr double kSquarePixels = 0.1;  // relative difference of fx and fy
constexpr double kCentre = 0.2;        // of the width or height, from the middle of the image

/// That of most images; empty if none could be read.
cv::Size usualSize(const std::vector<ImageFacts>& images) {
  std::map<std::pair<int, int>, std::size_t> sizes;
  for (const ImageFacts& image : images) {
    if (!image.size.empty()) ++sizes[{image.size.width, image.size.height}];
  }
  cv::Size usual;
  std::size_t most = 0;
  for (const auto& [size, n] : sizes) {
    if (n > most) usual = {size.first, size.second};
    most = std::max(most, n);
  }
  return usual;
}

std::string text(cv::Size size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

std::string againstImages(cv::Size told, cv::Size images) {
  std::string what = "the calibration is for " + text(told) + ", the images are " + text(images);
  const double x = static_cast<double>(told.width) / images.width;
  const double y = static_cast<double>(told.height) / images.height;
  if (told.width == images.height && told.height == images.width) return what + ": they were turned by 90 degrees";
  if (std::abs(x - y) < 0.01 * x) what += ": the same, scaled by " + number(1.0 / x);
  return what;
}

double degrees(int pixels, double focal_length) {
  return 2.0 * std::atan2(0.5 * pixels, focal_length) * kDegreesPerRadian;
}

/// What no usual camera has; empty if nothing.
std::string oddities(const CameraCalibration& c) {
  const double angle = degrees(c.width, c.fx);
  if (angle < kNarrowest || angle > kWidest) {
    return "fx of " + number(c.fx, 5) + " px at " + std::to_string(c.width) + " px width is a view of " +
           number(angle) + " degrees";
  }
  if (std::abs(c.fx - c.fy) > kSquarePixels * c.fx) {
    return "fx is " + number(c.fx, 5) + " px and fy " + number(c.fy, 5) + " px: pixels are square in most cameras";
  }
  const double dx = std::abs(c.cx - 0.5 * (c.width - 1)) / c.width;
  const double dy = std::abs(c.cy - 0.5 * (c.height - 1)) / c.height;
  if (dx > kCentre || dy > kCentre) {
    return "the centre is at (" + number(c.cx, 5) + ", " + number(c.cy, 5) + ") in an image of " +
           text({c.width, c.height});
  }
  return "";
}

}  // namespace

std::vector<Finding> judgeCalibration(const CameraFacts& facts) {
  std::vector<Finding> findings;
  if (!facts.calibration) return findings;
  const CameraCalibration& calibration = *facts.calibration;
  const cv::Size size = usualSize(facts.images);
  const cv::Size told(calibration.width, calibration.height);
  if (!size.empty() && size != told) findings.push_back({Check::kCameraInfoSize, againstImages(told, size)});
  try {
    validate(calibration);
  } catch (const std::invalid_argument& error) {
    findings.push_back({Check::kBadCameraInfo, error.what()});
    return findings;
  }
  const std::string odd = oddities(calibration);
  if (!odd.empty()) findings.push_back({Check::kOddCalibration, odd});
  return findings;
}

}  // namespace mba_vo
