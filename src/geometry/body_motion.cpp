#include "mba_vo/geometry/body_motion.h"

namespace mba_vo {

Vector6 BodyMotion::until(double t) const { return t * velocity + 0.5 * t * t * acceleration; }

}  // namespace mba_vo
