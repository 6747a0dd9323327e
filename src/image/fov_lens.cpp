#include "mba_vo/image/fov_lens.h"

#include <cmath>
#include <limits>

namespace mba_vo {
namespace {

constexpr double kStraight = 1e-6;  // [rad] below it the lens is a pinhole, to 1e-12 of the radius
constexpr double kQuarterTurn = 1.57079632679489661923;

}  // namespace

double fovDistortedRadius(double radius, double omega) {
  if (std::abs(omega) < kStraight) return radius;
  return std::atan(2.0 * radius * std::tan(0.5 * omega)) / omega;
}

double fovUndistortedRadius(double distorted_radius, double omega) {
  if (std::abs(omega) < kStraight) return distorted_radius;
  const double angle = distorted_radius * omega;
  if (std::abs(angle) >= kQuarterTurn) return std::numeric_limits<double>::infinity();
  return std::tan(angle) / (2.0 * std::tan(0.5 * omega));
}

}  // namespace mba_vo
