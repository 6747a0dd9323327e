#pragma once

#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// How a camera moves around a time: T(t) = T Exp(t v + t^2/2 a), in its own axes.
struct BodyMotion {
  Vector6 velocity = Vector6::Zero();      // [m/s, rad/s]
  Vector6 acceleration = Vector6::Zero();  // [m/s^2, rad/s^2]

  /// Log(T^-1 T(t)), t [s].
  Vector6 until(double t) const;
};

}  // namespace mba_vo
