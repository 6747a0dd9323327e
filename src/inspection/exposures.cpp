#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "mba_vo/inspection/judgements.h"
#include "wording.h"

namespace mba_vo {
namespace {

constexpr double kOtherUnit = 10.0;  // exposure over interval, from which on it is not just a wrong value
constexpr double kUnmatched = 0.02;  // share of the images; the last ones of a bag may lack it
constexpr double kLongOnes = 0.01;   // share of the exposures
constexpr double kMostlyZero = 0.5;  // share of the exposures

template <typename Predicate>
std::size_t count(const std::vector<ExposureFacts>& exposures, const Predicate& predicate) {
  return static_cast<std::size_t>(
      std::count_if(exposures.begin(), exposures.end(), [&](const ExposureFacts& e) { return predicate(e.seconds); }));
}

struct Unmatched {
  std::size_t images = 0;
  double usual_offset = 0.0;  // of the nearest exposure from its image [s]
};

Unmatched findUnmatched(const CameraFacts& facts) {
  Unmatched result;
  std::vector<double> offsets;
  for (const MatchedExposure& match : matchExposures(facts)) {
    if (std::llabs(match.offset_ns) <= kMatchingStampsNs) continue;
    ++result.images;
    offsets.push_back(1e-9 * static_cast<double>(match.offset_ns));
  }
  result.usual_offset = quantile(std::move(offsets), 0.5);
  return result;
}

/// Of those that are known: in seconds at all?
void judgeUnit(const std::vector<ExposureFacts>& exposures, double interval, std::vector<Finding>& findings) {
  const double usual = usualExposure(exposures);
  if (usual == 0.0) return;
  if (usual < kShortestUsualExposure) {
    findings.push_back({Check::kExposureTooShort,
                        "exposures are " + duration(usual) + ", 1000 times that would be " + duration(1e3 * usual)});
  }
  if (interval == 0.0) return;
  if (const auto unit = mistakenUnit(usual, interval)) {
    findings.push_back({Check::kExposureUnit, "exposures are " + number(usual, 6) + " s where images are " +
                                                  duration(interval) + " apart; these seem to be " + unit->name + ", " +
                                                  duration(usual * unit->seconds) + " (unit:=" + unit->text + ")"});
    return;
  }
  const std::size_t too_long =
      count(exposures, [&](double s) { return std::isfinite(s) && s > kLongestExposure * interval; });
  if (static_cast<double>(too_long) > kLongOnes * static_cast<double>(exposures.size())) {
    findings.push_back({Check::kExposureTooLong, countOf(too_long, exposures.size(), "exposures") +
                                                     " are longer than the " + duration(interval) +
                                                     " from image to image"});
  }
}

}  // namespace

std::optional<ExposureUnit> mistakenUnit(double usual, double interval) {
  if (usual <= kOtherUnit * interval) return std::nullopt;
  const std::vector<ExposureUnit> units = possibleUnits(usual, interval);
  return units.empty() ? std::nullopt : std::optional(units.front());
}

std::vector<Finding> judgeExposures(const CameraFacts& facts) {
  std::vector<Finding> findings;
  const std::vector<ExposureFacts>& exposures = facts.exposures;
  const std::size_t n = exposures.size();
  const std::size_t unknown = count(exposures, [](double s) { return std::isnan(s); });
  if (unknown == n) {
    const std::string why = n == 0 ? "nothing tells exposures" : "all " + std::to_string(n) + " exposures are unknown";
    findings.push_back({Check::kNoExposure, why});
    return findings;
  }
  if (unknown > 0) {
    findings.push_back({Check::kExposureUnknown, countOf(unknown, n, "exposures") + " are not a number: unknown"});
  }
  const std::size_t invalid = count(exposures, [](double s) { return std::isinf(s) || s < 0.0; });
  if (invalid > 0) {
    findings.push_back({Check::kExposureInvalid, countOf(invalid, n, "exposures") + " are negative or infinite"});
  }
  const std::size_t zero = count(exposures, [](double s) { return s == 0.0; });
  if (static_cast<double>(zero) > kMostlyZero * static_cast<double>(n)) {
    findings.push_back({Check::kExposureZero, countOf(zero, n, "exposures") + " are 0"});
  }
  judgeUnit(exposures, usualInterval(facts.images), findings);
  const Unmatched unmatched = findUnmatched(facts);
  if (static_cast<double>(unmatched.images) > kUnmatched * static_cast<double>(facts.images.size())) {
    findings.push_back({Check::kExposureUnmatched, countOf(unmatched.images, facts.images.size()) +
                                                       " have no exposure of their stamp; the nearest is usually " +
                                                       duration(unmatched.usual_offset) + " off"});
  }
  return findings;
}

}  // namespace mba_vo
