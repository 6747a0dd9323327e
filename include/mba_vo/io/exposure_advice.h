#pragma once

#include <string>
#include <vector>

namespace mba_vo {

/// Shorter exposures are rare in daylight, and 1000 times less than one that shows blur [s].
inline constexpr double kShortestUsualExposure = 50e-6;
/// Exposure over the interval from image to image; stamps jitter.
inline constexpr double kLongestExposure = 1.1;

/// A unit that may have been taken for seconds.
struct ExposureUnit {
  const char* name;
  const char* text;  // in seconds, as one would write it
  double seconds;
};

/// Those in which an exposure of the number `exposure` would be a usual one where images are `interval` [s] apart.
std::vector<ExposureUnit> possibleUnits(double exposure, double interval);

/// What is suspicious about exposures of `exposure` [s], NaN = unknown, where images are `interval` [s] apart: as if
/// another unit had been taken for seconds. Names the unit that they may be in and the factor that makes seconds of
/// it. Empty if there is nothing to say. `source`: who told them, begins the text.
std::string exposureAdvice(const std::string& source, double exposure, double interval);

}  // namespace mba_vo
