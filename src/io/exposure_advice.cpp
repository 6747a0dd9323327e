#include "mba_vo/io/exposure_advice.h"

#include <cmath>
#include <sstream>

namespace mba_vo {
namespace {

// Shorter ones are rare in daylight, and 1000 times less than an exposure that shows blur.
constexpr double kShortest = 50e-6;  // [s]
constexpr double kLongest = 1.1;     // exposure over interval; stamps jitter
constexpr double kThousand = 1e3;    // from one unit to the next

struct Unit {
  const char* name;
  const char* seconds;  // as one would write it
  double value;         // [s]
};
constexpr Unit kUnits[] = {
    {"milliseconds", "1e-3", 1e-3}, {"microseconds", "1e-6", 1e-6}, {"nanoseconds", "1e-9", 1e-9}};

}  // namespace

std::string exposureAdvice(const std::string& source, double exposure, double interval) {
  const bool too_long = exposure > kLongest * interval;
  const bool too_short = exposure > 0.0 && exposure < kShortest;
  std::ostringstream text;
  if (too_long) {
    text << source << " is " << exposure << " s, but images are " << interval << " s apart";
    for (const Unit& unit : kUnits) {
      const double seconds = exposure * unit.value;
      if (seconds < kShortest || seconds > kLongest * interval) continue;
      text << "; if these are " << unit.name << ", it is " << seconds << " s (unit " << unit.seconds << ")";
    }
  } else if (too_short) {
    text << source << " is " << 1e6 * exposure << " us, unusually short: is its unit right?";
    if (kThousand * exposure <= kLongest * interval) {
      text << " 1000 times as long would be " << kThousand * exposure << " s";
    }
  }
  return text.str();
}

}  // namespace mba_vo
