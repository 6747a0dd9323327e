#pragma once

#include <chrono>
#include <cstddef>
#include <ostream>
#include <string>

namespace mba_vo {

/// A line that is drawn over again; draws nothing if not `enabled` (no terminal).
class ProgressBar {
 public:
  /// Of `total` the first `left_out` are not worked on: they do not count, and neither does their time.
  ProgressBar(std::ostream& out, std::size_t total, bool enabled, std::size_t left_out = 0);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `done`: with those left out.
  void update(std::size_t done);

 private:
  std::ostream& out_;
  std::size_t left_out_;
  std::size_t total_;  // without them
  bool enabled_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point last_drawn_;
};

/// How long the rest takes if it goes on as it went for `seconds` [s]: "1:05 left", "2:00:10 left"; "in 1:05" when all
/// is done.
std::string timeLeft(std::size_t done, std::size_t total, double seconds);

}  // namespace mba_vo
