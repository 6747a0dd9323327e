#include "mba_vo/inspection/camera_facts.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(std::lround(q * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

double usualInterval(const std::vector<ImageFacts>& images) {
  std::vector<double> intervals;
  constexpr std::size_t kSpan = 2;  // intervals: stamps that are early and late by turns do no harm
  for (std::size_t i = kSpan; i < images.size(); ++i) {
    const std::int64_t span = images[i].stamp_ns - images[i - kSpan].stamp_ns;
    if (span > 0) intervals.push_back(1e-9 * static_cast<double>(span) / kSpan);
  }
  return quantile(std::move(intervals), 0.5);
}

double usualExposure(const std::vector<ExposureFacts>& exposures) {
  std::vector<double> known;
  for (const ExposureFacts& exposure : exposures) {
    if (std::isfinite(exposure.seconds) && exposure.seconds > 0.0) known.push_back(exposure.seconds);
  }
  return quantile(std::move(known), 0.5);
}

double usualBlur(const CameraFacts& facts) {
  std::vector<double> lengths;
  for (const ImageFacts& image : facts.images) {
    if (image.motion) lengths.push_back(image.motion->length);
  }
  const double interval = usualInterval(facts.images);
  const double exposure = usualExposure(facts.exposures);
  constexpr double kWholeInterval = 1.1;  // beyond, the exposure is wrong
  if (interval == 0.0 || exposure > kWholeInterval * interval) return 0.0;
  return exposure / interval * quantile(std::move(lengths), 0.5);
}

}  // namespace mba_vo
