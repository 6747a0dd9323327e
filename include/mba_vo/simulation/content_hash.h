#pragma once

#include <cstddef>
#include <cstdint>

namespace mba_vo {

/// FNV-1a: the same on every machine, unlike std::hash.
inline std::uint64_t contentHash(const void* data, std::size_t bytes) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  const auto* byte = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < bytes; ++i) hash = (hash ^ byte[i]) * 0x100000001B3ULL;
  return hash;
}

}  // namespace mba_vo
