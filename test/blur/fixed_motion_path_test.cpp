#include "mba_vo/blur/fixed_motion_path.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::fixed_motion_path_test {
namespace {

const PinholeCamera kReferenceCamera{752, 480, 430.0, 425.0, 375.5, 239.5};
const PinholeCamera kCamera{640, 480, 520.0, 510.0, 320.5, 238.0};

void expectNear(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double tolerance) {
  EXPECT_LT((a - b).norm(), tolerance * (1.0 + b.norm()));
}

TEST(FixedMotionPath, IsThatOfPatchPathMaker) {
  test::Random random(5);
  for (int i = 0; i < 200; ++i) {
    const bool moving = i % 4 != 0;
    const Vector6 xi = moving ? random.tangent(0.05, 0.1) : Vector6::Zero();
    const ExposureTrajectory trajectory{random.pose(0.2, 0.2), xi / 0.02, 0.02};
    const Eigen::Vector2d pixel(random.uniform(50, 600), random.uniform(50, 430));
    const double inverse_depth = random.uniform(0.2, 1.5);
    PatchPath expected, path, light;
    ASSERT_TRUE(PatchPathMaker(kReferenceCamera, kCamera, trajectory).make(pixel, inverse_depth, expected));
    const FixedMotionPathMaker maker(kReferenceCamera, kCamera, trajectory);
    ASSERT_TRUE(maker.make(pixel, inverse_depth, path));
    ASSERT_TRUE(maker.makeWithoutPose(pixel, inverse_depth, light));
    for (const PatchPath* p : {&path, &light}) {
      EXPECT_LT((p->c0 - expected.c0).norm(), 1e-3F);
      EXPECT_LT((p->c1 - expected.c1).norm(), 1e-4F);
      EXPECT_LT((p->c2 - expected.c2).norm(), 1e-4F);
      EXPECT_LT((p->A0 - expected.A0).norm(), 1e-5F);
      EXPECT_LT((p->A1 - expected.A1).norm(), 1e-5F);
    }
    for (std::size_t part = 0; part < 2; ++part) {
      expectNear(path.J_pose[part], expected.J_pose[part], 1e-9);
      expectNear(path.J_inverse_depth[part], expected.J_inverse_depth[part], 1e-9);
      expectNear(light.J_inverse_depth[part], expected.J_inverse_depth[part], 1e-9);
    }
  }
}

TEST(FixedMotionPath, PlaneBehindTheCameraIsInvalid) {
  const SE3 T(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, 3.0));
  const FixedMotionPathMaker maker(kReferenceCamera, kCamera, {T, Vector6::Zero(), 0.0});
  PatchPath path;
  EXPECT_FALSE(maker.make({300.0, 200.0}, 0.5, path));
  EXPECT_FALSE(maker.make({300.0, 200.0}, -0.1, path));
  EXPECT_TRUE(maker.make({300.0, 200.0}, 0.2, path));
}

}  // namespace
}  // namespace mba_vo::fixed_motion_path_test
