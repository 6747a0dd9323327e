#pragma once

namespace mba_vo {

constexpr double kPi = 3.14159265358979323846;
constexpr double kTwoPi = 2.0 * kPi;
constexpr double kDegreesPerRadian = 180.0 / kPi;

}  // namespace mba_vo
