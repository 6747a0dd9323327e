#include "mba_vo/io/progress_bar.h"

#include <algorithm>
#include <iomanip>
#include <string>

namespace mba_vo {

ProgressBar::ProgressBar(std::ostream& out, std::size_t total, bool enabled)
    : out_(out), total_(std::max<std::size_t>(total, 1)), enabled_(enabled), begin_(std::chrono::steady_clock::now()) {}

ProgressBar::~ProgressBar() {
  if (drawn_) {
    out_ << "\n";
  }
}

void ProgressBar::update(std::size_t done) {
  using std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kInterval(100);
  const steady_clock::time_point now = steady_clock::now();
  if (!enabled_ || (drawn_ && done < total_ && now - last_drawn_ < kInterval)) {
    return;
  }
  constexpr std::size_t kWidth = 40;
  const std::size_t filled = std::min(kWidth, kWidth * done / total_);
  const double seconds = std::chrono::duration<double>(now - begin_).count();
  const double rate = seconds > 0.0 ? static_cast<double>(done) / seconds : 0.0;
  out_ << "\r[" << std::string(filled, '=') << std::string(kWidth - filled, ' ') << "] " << done << "/" << total_
       << ", " << std::fixed << std::setprecision(1) << rate << " images/s " << std::flush;
  drawn_ = true;
  last_drawn_ = now;
}

}  // namespace mba_vo
