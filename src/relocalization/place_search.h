#pragma once

#include <cstddef>

namespace mba_vo {

/// For each of 16 keyframes the largest product of its pixels (interleaved, [pixel][keyframe]) with one of the shifted
/// views ([shift][pixel]), times the keyframe's inverse norm at that shift ([shift][keyframe]), and which shift that
/// is.
void bestProducts(const float* views, const float* pixels, const float* inverse_norms, float* best, int* best_shift);

}  // namespace mba_vo
