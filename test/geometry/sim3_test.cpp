#include "mba_vo/geometry/sim3.h"

#include <gtest/gtest.h>

namespace mba_vo::sim3_test {
namespace {

Sim3 example(double seed) {
  Vector7 v;
  v << 0.3 * seed, -0.7, 1.1 - seed, 0.4 * seed, -0.9, 0.2 + 0.1 * seed, 0.3 * (seed - 1.5);
  return Sim3::fromIncrement(v);
}

/// By its definition, as a matrix that acts on (p, 1).
Eigen::Matrix4d matrixOf(const Sim3& S) {
  Eigen::Matrix4d M = Eigen::Matrix4d::Identity();
  M.topLeftCorner<3, 3>() = S.scale() * S.rotationMatrix();
  M.topRightCorner<3, 1>() = S.translation();
  return M;
}

TEST(Sim3, IsAGroupThatActsAsItsMatricesDo) {
  const Sim3 a = example(1.0), b = example(2.0), c = example(3.0);
  EXPECT_TRUE(matrixOf(a * b).isApprox(matrixOf(a) * matrixOf(b), 1e-12));
  EXPECT_TRUE(matrixOf((a * b) * c).isApprox(matrixOf(a * (b * c)), 1e-12));
  EXPECT_TRUE(matrixOf(a * Sim3()).isApprox(matrixOf(a), 1e-12));
  EXPECT_TRUE(matrixOf(Sim3() * a).isApprox(matrixOf(a), 1e-12));
  EXPECT_TRUE(matrixOf(a.inverse()).isApprox(matrixOf(a).inverse(), 1e-12));
  EXPECT_TRUE(matrixOf(a * a.inverse()).isIdentity(1e-12));
  EXPECT_TRUE(matrixOf(a.inverse() * a).isIdentity(1e-12));
  const Eigen::Vector3d p(0.2, -3.0, 1.4);
  EXPECT_TRUE((a * p).homogeneous().isApprox(matrixOf(a) * p.homogeneous(), 1e-12));
}

TEST(Sim3, IncrementsGoThereAndBack) {
  for (const double seed : {0.0, 1.0, 2.0, 5.0}) {
    const Sim3 S = example(seed);
    EXPECT_TRUE(matrixOf(Sim3::fromIncrement(S.increment())).isApprox(matrixOf(S), 1e-12));
  }
  EXPECT_TRUE(Sim3().increment().isZero(1e-15));
}

}  // namespace
}  // namespace mba_vo::sim3_test
