#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <utility>

#include "mba_vo/image/parallel_for.h"

namespace mba_vo {

/// A value that is made when it is first asked for, by whichever thread.
template <typename T>
class Lazy {
 public:
  explicit Lazy(std::function<T()> make) : make_(std::move(make)) {}

  const T& get() const {
    // Threads of a loop in make() could else take up work from outside it that waits for this very value.
    std::call_once(once_, [this] { isolated([this] { value_.emplace(make_()); }); });
    return *value_;
  }

 private:
  std::function<T()> make_;
  mutable std::once_flag once_;
  mutable std::optional<T> value_;
};

}  // namespace mba_vo
