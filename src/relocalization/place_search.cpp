#include "place_search.h"

#include <array>

#include "mba_vo/image/multiversion.h"
#include "mba_vo/relocalization/place_index.h"

namespace mba_vo {
namespace {

constexpr int kLanes = static_cast<int>(PlaceIndex::kLanes);
constexpr int kAtOnce = 7;  // shifts, as many as there are registers for

}  // namespace

MBA_VO_MULTIVERSION
void bestProducts(const float* views, const float* pixels, const float* inverse_norms, float* best, int* best_shift) {
  for (int lane = 0; lane < kLanes; ++lane) {
    best[lane] = -1.0F;
    best_shift[lane] = 0;
  }
  for (int first = 0; first < PlaceDescriptor::kShifts; first += kAtOnce) {
    float sums[kAtOnce][kLanes] = {};
    for (int p = 0; p < PlaceDescriptor::kPixels; ++p) {
      for (int s = 0; s < kAtOnce; ++s) {
        const float view = views[(first + s) * PlaceDescriptor::kPixels + p];
        for (int lane = 0; lane < kLanes; ++lane) sums[s][lane] += view * pixels[p * kLanes + lane];
      }
    }
    for (int s = 0; s < kAtOnce; ++s) {
      for (int lane = 0; lane < kLanes; ++lane) {
        const float value = sums[s][lane] * inverse_norms[(first + s) * kLanes + lane];
        best_shift[lane] = value > best[lane] ? first + s : best_shift[lane];
        best[lane] = value > best[lane] ? value : best[lane];
      }
    }
  }
}

}  // namespace mba_vo
