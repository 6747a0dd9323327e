#include "mba_vo/odometry/tracking_load.h"

namespace mba_vo {
namespace {

constexpr double kImages = 30.0;  // that count, a second at 30 Hz: longer than a burst of work of the mapper
constexpr double kMost = 0.3;     // of them; a machine that keeps up has single ones, one that does not all

}  // namespace

bool TrackingLoad::isTooHigh(bool waited) {
  share_ += ((waited ? 1.0 : 0.0) - share_) / kImages;
  if (share_ < kMost) return false;
  share_ = 0.0;  // what is done about it needs time to show
  return true;
}

}  // namespace mba_vo
