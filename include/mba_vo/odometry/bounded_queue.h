#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace mba_vo {

/// Queue between those who bring something and the one who works on it, bounded in bytes. What is shed when it is full
/// is chosen by the owner and handed back, so that it can be counted. Thread-safe.
template <typename Item>
class BoundedQueue {
 public:
  using Size = std::function<std::size_t(const Item&)>;                      // [bytes]
  using ChooseVictim = std::function<std::size_t(const std::deque<Item>&)>;  // what to shed; the newest = nothing

  BoundedQueue(std::size_t max_bytes, Size size, ChooseVictim choose_victim)
      : max_bytes_(max_bytes), size_(std::move(size)), choose_victim_(std::move(choose_victim)) {}

  /// Never waits for the worker. Returns what had to be shed; the newest of all is always kept.
  std::vector<Item> push(Item item) {
    std::vector<Item> shed;
    const std::lock_guard<std::mutex> lock(mutex_);
    bytes_ += size_(item);
    items_.push_back(std::move(item));
    while (bytes_ > max_bytes_) {
      const std::size_t index = choose_victim_(items_);
      if (index + 1 >= items_.size()) break;
      const auto victim = items_.begin() + static_cast<std::ptrdiff_t>(index);
      bytes_ -= size_(*victim);
      shed.push_back(std::move(*victim));
      items_.erase(victim);
    }
    return shed;
  }

  /// The oldest item; nullopt if there is none.
  std::optional<Item> pop() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (items_.empty()) return std::nullopt;
    Item item = std::move(items_.front());
    items_.pop_front();
    bytes_ -= size_(item);
    return item;
  }

  bool empty() const { return size() == 0; }

  std::size_t size() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return items_.size();
  }

  std::size_t bytes() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return bytes_;
  }

 private:
  const std::size_t max_bytes_;
  const Size size_;
  const ChooseVictim choose_victim_;
  mutable std::mutex mutex_;
  std::deque<Item> items_;
  std::size_t bytes_ = 0;
};

}  // namespace mba_vo
