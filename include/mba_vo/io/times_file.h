#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mba_vo {

/// One line of times.txt: `id t_mid[s] exposure[ms]`.
struct ImageTime {
  std::uint64_t id = 0;
  std::int64_t mid_exposure_ns = 0;  // [ns]
  std::optional<double> exposure;    // [s] as written, even if impossible; nullopt = unknown (0 or no third column)
};

/// Reads times.txt, `#` begins a comment. Throws std::runtime_error naming file and line if malformed or empty.
std::vector<ImageTime> readTimesFile(const std::string& file);

}  // namespace mba_vo
