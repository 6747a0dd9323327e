#pragma once

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <ros/console.h>

namespace mba_vo {

/// What this process says on the console from now on, warnings and what is worse with "WARN " before them.
class ConsoleLines : public ros::console::LogAppender {
 public:
  ConsoleLines() { ros::console::register_appender(this); }
  ~ConsoleLines() override { ros::console::deregister_appender(this); }
  ConsoleLines(const ConsoleLines&) = delete;
  ConsoleLines& operator=(const ConsoleLines&) = delete;

  void log(ros::console::Level level, const char* text, const char* /*file*/, const char* /*function*/,
           int /*line*/) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    lines_.push_back((level >= ros::console::levels::Warn ? "WARN " : "") + std::string(text));
  }
  std::vector<std::string> take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(lines_, {});
  }
  /// How many begin so.
  std::size_t count(const std::string& begin) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return static_cast<std::size_t>(std::count_if(lines_.begin(), lines_.end(),
                                                  [&](const std::string& line) { return line.rfind(begin, 0) == 0; }));
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
};

}  // namespace mba_vo
