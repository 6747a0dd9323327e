#include "mba_vo/io/exposure_advice.h"

#include <cmath>
#include <sstream>

namespace mba_vo {
namespace {

constexpr double kThousand = 1e3;  // from one unit to the next
constexpr ExposureUnit kUnits[] = {
    {"milliseconds", "1e-3", 1e-3}, {"microseconds", "1e-6", 1e-6}, {"nanoseconds", "1e-9", 1e-9}};

}  // namespace

std::vector<ExposureUnit> possibleUnits(double exposure, double interval) {
  std::vector<ExposureUnit> units;
  for (const ExposureUnit& unit : kUnits) {
    const double seconds = exposure * unit.seconds;
    if (seconds >= kShortestUsualExposure && seconds <= kLongestExposure * interval) units.push_back(unit);
  }
  return units;
}

std::string exposureAdvice(const std::string& source, double exposure, double interval) {
  const bool too_long = exposure > kLongestExposure * interval;
  const bool too_short = exposure > 0.0 && exposure < kShortestUsualExposure;
  std::ostringstream text;
  if (too_long) {
    text << source << " is " << exposure << " s, but images are " << interval << " s apart";
    for (const ExposureUnit& unit : possibleUnits(exposure, interval)) {
      text << "; if these are " << unit.name << ", it is " << exposure * unit.seconds << " s (unit " << unit.text
           << ")";
    }
  } else if (too_short) {
    text << source << " is " << 1e6 * exposure << " us, unusually short: is its unit right?";
    if (kThousand * exposure <= kLongestExposure * interval) {
      text << " 1000 times as long would be " << kThousand * exposure << " s";
    }
  }
  return text.str();
}

}  // namespace mba_vo
