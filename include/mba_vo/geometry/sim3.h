#pragma once

#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// Increment of a similarity: translation [units of the frame it is applied in], rotation [rad], logarithm of the
/// scale.
using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;

/// Similarity p_a = scale R p_b + t. `S_a_b` maps the coordinates of a point in b, in b's unit of length, to its
/// coordinates in a, in a's. Increments are (t, log R, log scale), each by itself: simpler than the exponential of the
/// group, and as good for an optimiser.
class Sim3 {
 public:
  Sim3() = default;
  explicit Sim3(const SE3& T, double scale = 1.0) : T_(T), scale_(scale) {}

  /// (v0..2, Exp(v3..5), exp(v6)).
  static Sim3 fromIncrement(const Vector7& v);
  /// The inverse of that.
  Vector7 increment() const;

  const Eigen::Quaterniond& rotation() const { return T_.rotation(); }
  Eigen::Matrix3d rotationMatrix() const { return T_.rotationMatrix(); }
  const Eigen::Vector3d& translation() const { return T_.translation(); }
  double scale() const { return scale_; }
  /// Rotation and translation, the latter in a's unit.
  const SE3& rigid() const { return T_; }

  Sim3 inverse() const;
  Sim3 operator*(const Sim3& other) const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const;

 private:
  SE3 T_;
  double scale_ = 1.0;
};

}  // namespace mba_vo
