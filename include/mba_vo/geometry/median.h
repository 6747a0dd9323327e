#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace mba_vo {

/// The value in the middle, the upper one of two; 0 if there are none.
template <typename Value>
Value median(std::vector<Value> values) {
  if (values.empty()) return Value{};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace mba_vo
