#include "mba_vo/trajectory/alignment_covariance.h"

namespace mba_vo {
namespace {

// Chosen with the other numbers of OdometryCovariance, see there.
constexpr double kNoiseShare = 0.5;  // of an alignment's covariance; what consecutive frames share is in it
constexpr double kModelError = 0.1;  // [px] of expected error at which wrong depths add once that covariance

}  // namespace

Matrix12 alignmentCovariance(const TrackedFrame& tracked) {
  const double badness = tracked.expected_error / kModelError;
  return (kNoiseShare + badness * badness) * tracked.covariance;
}

}  // namespace mba_vo
