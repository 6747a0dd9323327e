#include "mba_vo/inspection/camera_facts.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>

#include "mba_vo/io/exposure_advice.h"

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
  // Over two: stamps that are early and late by turns do no harm.
  const std::size_t steps = images.size() == 2 ? 1 : 2;
  for (std::size_t i = steps; i < images.size(); ++i) {
    const std::int64_t span = images[i].stamp_ns - images[i - steps].stamp_ns;
    if (span > 0) intervals.push_back(1e-9 * static_cast<double>(span) / static_cast<double>(steps));
  }
  return quantile(std::move(intervals), 0.5);
}

std::vector<MatchedExposure> matchExposures(const CameraFacts& facts) {
  std::vector<MatchedExposure> matches;
  std::vector<ExposureFacts> sorted = facts.exposures;
  if (sorted.empty()) return matches;
  const auto isEarlier = [](const ExposureFacts& a, const ExposureFacts& b) { return a.stamp_ns < b.stamp_ns; };
  std::stable_sort(sorted.begin(), sorted.end(), isEarlier);
  for (const ImageFacts& image : facts.images) {
    auto nearest = std::lower_bound(sorted.begin(), sorted.end(), ExposureFacts{image.stamp_ns, 0.0}, isEarlier);
    const bool before =
        nearest == sorted.end() || (nearest != sorted.begin() && image.stamp_ns - std::prev(nearest)->stamp_ns <
                                                                     std::llabs(nearest->stamp_ns - image.stamp_ns));
    if (before) --nearest;
    const std::int64_t offset = nearest->stamp_ns - image.stamp_ns;
    const bool matches_it = std::llabs(offset) <= kMatchingStampsNs;
    matches.push_back({matches_it ? nearest->seconds : std::numeric_limits<double>::quiet_NaN(), offset});
  }
  return matches;
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
  if (interval == 0.0 || exposure > kLongestExposure * interval) return 0.0;
  return exposure / interval * quantile(std::move(lengths), 0.5);
}

}  // namespace mba_vo
