#pragma once

#include <string>

namespace mba_vo {

/// What is suspicious about exposures of `exposure` [s], NaN = unknown, where images are `interval` [s] apart: as if
/// another unit had been taken for seconds. Names the unit that they may be in and the factor that makes seconds of
/// it. Empty if there is nothing to say. `source`: who told them, begins the text.
std::string exposureAdvice(const std::string& source, double exposure, double interval);

}  // namespace mba_vo
