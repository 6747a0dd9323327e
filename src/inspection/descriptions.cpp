#include <algorithm>
#include <cmath>
#include <map>

#include "mba_vo/inspection/inspection_report.h"
#include "wording.h"

namespace mba_vo {
namespace {

/// "mono8", or "bgr8 (3), mono8 (200)".
std::string encodings(const std::vector<ImageFacts>& images) {
  std::map<std::string, std::size_t> counts;
  for (const ImageFacts& image : images) ++counts[image.encoding];
  std::string text;
  for (const auto& [encoding, n] : counts) {
    text += (text.empty() ? "" : ", ") + encoding + (counts.size() > 1 ? " (" + std::to_string(n) + ")" : "");
  }
  return text;
}

std::string describeImages(const CameraFacts& facts) {
  const auto readable = std::find_if(facts.images.begin(), facts.images.end(),
                                     [](const ImageFacts& image) { return !image.size.empty(); });
  std::string text = "images       " + std::to_string(facts.images.size());
  if (readable != facts.images.end()) {
    text += ", " + std::to_string(readable->size.width) + "x" + std::to_string(readable->size.height);
  }
  text += ", " + encodings(facts.images);
  if (facts.white_level > 0.0) text += ", white at " + number(facts.white_level, 5);
  return text;
}

std::string describeTime(const std::vector<ImageFacts>& images) {
  const double interval = usualInterval(images);
  if (interval == 0.0) return "time         no two stamps that increase";
  const auto [first, last] = std::minmax_element(
      images.begin(), images.end(), [](const ImageFacts& a, const ImageFacts& b) { return a.stamp_ns < b.stamp_ns; });
  return "time         " + duration(1e-9 * static_cast<double>(last->stamp_ns - first->stamp_ns)) + ", " +
         number(1.0 / interval) + " Hz";
}

std::string describeExposure(const CameraFacts& facts) {
  std::vector<double> known;
  for (const ExposureFacts& exposure : facts.exposures) {
    if (std::isfinite(exposure.seconds)) known.push_back(exposure.seconds);
  }
  if (known.empty()) return "exposure     unknown";
  return "exposure     " + duration(quantile(known, 0.5)) + " (" + duration(quantile(known, 0.0)) + " to " +
         duration(quantile(known, 1.0)) + "), " + std::to_string(known.size()) + " told";
}

std::string describeCalibration(const CameraFacts& facts) {
  if (!facts.calibration) return "calibration  none";
  const CameraCalibration& c = *facts.calibration;
  return "calibration  " + std::to_string(c.width) + "x" + std::to_string(c.height) + ", fx " + number(c.fx, 5) +
         " fy " + number(c.fy, 5) + " cx " + number(c.cx, 5) + " cy " + number(c.cy, 5) + ", " +
         (c.distortion_model.empty() ? "no distortion" : c.distortion_model);
}

template <typename Value>
std::vector<double> collect(const std::vector<ImageFacts>& images, const Value& value) {
  std::vector<double> values;
  for (const ImageFacts& image : images) {
    if (!image.size.empty()) values.push_back(value(image));
  }
  return values;
}

std::string describeLight(const std::vector<ImageFacts>& images) {
  const auto mean = collect(images, [](const ImageFacts& image) { return image.pixels.mean; });
  const auto white = collect(images, [](const ImageFacts& image) { return image.pixels.saturated; });
  const auto detail = collect(images, [](const ImageFacts& image) { return image.pixels.detail; });
  return "light        mean " + number(1e2 * quantile(mean, 0.5), 2) + " % of white, " +
         number(1e2 * quantile(white, 0.5), 2) + " % of the pixels white; fine detail " +
         number(quantile(detail, 0.5), 2) + " (median), " + number(quantile(detail, 0.95), 2) + " (sharpest)";
}

std::string describeMotion(const CameraFacts& facts) {
  std::vector<double> lengths;
  for (const ImageFacts& image : facts.images) {
    if (image.motion) lengths.push_back(image.motion->length);
  }
  if (lengths.empty()) return "motion       cannot be told";
  std::string text = "motion       " + number(quantile(lengths, 0.5), 2) + " px from image to image (median), " +
                     number(quantile(lengths, 0.9), 2) + " px (90 %)";
  const double blur = usualBlur(facts);
  if (blur > 0.0) text += "; blur " + number(blur, 2) + " px (median)";
  return text;
}

}  // namespace

std::vector<std::string> describe(const CameraFacts& facts) {
  if (facts.images.empty()) return {"images       none", describeCalibration(facts)};
  return {describeImages(facts),      describeTime(facts.images),  describeExposure(facts),
          describeCalibration(facts), describeLight(facts.images), describeMotion(facts)};
}

}  // namespace mba_vo
