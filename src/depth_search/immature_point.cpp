#include "mba_vo/depth_search/immature_point.h"

namespace mba_vo {
namespace {

constexpr double kCertainSearch = 8.0;  // [px] a longer last search leaves the depth ambiguous
constexpr double kMinQuality = 3.0;

}  // namespace

bool isReadyToActivate(const ImmaturePoint& point) {
  using State = ImmaturePoint::State;
  if (point.measured.known()) return true;
  const bool searched = point.state == State::kGood || point.state == State::kSkipped ||
                        point.state == State::kBadCondition || point.state == State::kOutOfBounds;
  return searched && point.hasDepth() && point.inverseDepth() > 0.0 && point.last_search_length_px < kCertainSearch &&
         point.quality > kMinQuality;
}

}  // namespace mba_vo
