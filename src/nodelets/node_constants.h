#pragma once

namespace mba_vo {

constexpr double kStatusPeriod = 1.0;  // of status messages [s]
constexpr double kWarnPeriod = 5.0;    // at most one warning of a kind in it [s]
constexpr double kBytesPerMegabyte = 1e6;

}  // namespace mba_vo
