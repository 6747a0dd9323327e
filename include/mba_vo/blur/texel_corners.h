#pragma once

#include <cstring>

namespace mba_vo {

/// The four corners of each of `Lanes` samples for bilinear interpolation, `Lanes` a multiple of 8. `index` names the
/// upper left one in `data`. Two neighbours are read at a time and sorted by shuffling: half the loads of reading them
/// one by one, and gather instructions are no faster and not everywhere. Inlined into the versions for each instruction
/// set.
template <int Lanes>
[[gnu::always_inline]] inline void readCorners(const float* data, int stride, const int* index, float* __restrict i00,
                                               float* __restrict i10, float* __restrict i01, float* __restrict i11) {
  using Two = float __attribute__((vector_size(2 * sizeof(float))));
  using Eight = float __attribute__((vector_size(8 * sizeof(float))));
  static_assert(Lanes % 8 == 0);
  const auto readRow = [&](const float* row, float* __restrict left, float* __restrict right) {
#pragma GCC unroll 2
    for (int k = 0; k < Lanes; k += 8) {
      Two pairs[8];
#pragma GCC unroll 8
      for (int i = 0; i < 8; ++i) std::memcpy(&pairs[i], row + index[k + i], sizeof(Two));
      const auto a = __builtin_shufflevector(pairs[0], pairs[1], 0, 1, 2, 3);
      const auto b = __builtin_shufflevector(pairs[2], pairs[3], 0, 1, 2, 3);
      const auto c = __builtin_shufflevector(pairs[4], pairs[5], 0, 1, 2, 3);
      const auto d = __builtin_shufflevector(pairs[6], pairs[7], 0, 1, 2, 3);
      const Eight ac = __builtin_shufflevector(a, c, 0, 1, 2, 3, 4, 5, 6, 7);
      const Eight bd = __builtin_shufflevector(b, d, 0, 1, 2, 3, 4, 5, 6, 7);
      const Eight lefts = __builtin_shufflevector(ac, bd, 0, 2, 8, 10, 4, 6, 12, 14);
      const Eight rights = __builtin_shufflevector(ac, bd, 1, 3, 9, 11, 5, 7, 13, 15);
      std::memcpy(left + k, &lefts, sizeof(Eight));
      std::memcpy(right + k, &rights, sizeof(Eight));
    }
  };
  readRow(data, i00, i10);
  readRow(data + stride, i01, i11);
}

}  // namespace mba_vo
