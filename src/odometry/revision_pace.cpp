#include "mba_vo/odometry/revision_pace.h"

namespace mba_vo {
namespace {

// Live runs in simulated time (docs/decisions/2026-11-27-slow-cores.md).
constexpr int kWaitsFor = 3;                  // images
constexpr std::int64_t kRest = 1000000000LL;  // [ns] a try delays that many images: a tenth at 30 Hz

}  // namespace

bool RevisionPace::isTooSlow(std::size_t waiting, std::int64_t image_ns) {
  if (waiting < least_) {
    least_ = waiting;
    images_ = 0;
    return false;
  }
  if (++images_ < kWaitsFor) return false;
  rests_until_ns_ = image_ns + kRest;
  return true;
}

}  // namespace mba_vo
