#pragma once

#include <chrono>
#include <cstddef>
#include <ostream>

namespace mba_vo {

/// A line that is drawn over again; draws nothing if not `enabled` (no terminal).
class ProgressBar {
 public:
  ProgressBar(std::ostream& out, std::size_t total, bool enabled);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::size_t done);

 private:
  std::ostream& out_;
  std::size_t total_;
  bool enabled_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point last_drawn_;
};

}  // namespace mba_vo
