#pragma once

#include <cstddef>
#include <iomanip>
#include <sstream>
#include <string>

namespace mba_vo {

/// "3 of 200 images".
inline std::string countOf(std::size_t n, std::size_t all, const char* what = "images") {
  return std::to_string(n) + " of " + std::to_string(all) + " " + what;
}

/// With so many significant digits.
inline std::string number(double value, int digits = 3) {
  std::ostringstream text;
  text << std::setprecision(digits) << value;
  return text.str();
}

/// A time in the unit that suits it.
inline std::string duration(double seconds) {
  const double size = seconds < 0.0 ? -seconds : seconds;
  if (size < 1e-3) return number(1e6 * seconds) + " us";
  return size < 1.0 ? number(1e3 * seconds) + " ms" : number(seconds, 4) + " s";
}

}  // namespace mba_vo
