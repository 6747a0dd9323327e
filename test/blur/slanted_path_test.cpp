#include <gtest/gtest.h>

#include "mba_vo/blur/patch_path.h"
#include "support/random.h"

namespace mba_vo::slanted_path_test {
namespace {

const PinholeCamera kCamera{640, 480, 500.0, 510.0, 319.5, 239.5};
constexpr double kInverseDepth = 0.6;
const Eigen::Vector2d kSlope(0.0015, -0.001);
const Eigen::Vector2d kPixel(310.0, 190.0);

/// Where the ray of a pixel meets the plane, found on the plane itself: n . P = 1 with n . r(x) = the inverse depth at
/// x.
Eigen::Vector2d intersect(const SE3& T_reference_camera, const Eigen::Vector2d& pixel, double inverse_depth,
                          const Eigen::Vector2d& anchor) {
  const auto at = [&](double x, double y) { return inverse_depth + kSlope.dot(Eigen::Vector2d(x, y) - anchor); };
  const double n_z = at(kCamera.cx, kCamera.cy);
  const Eigen::Vector3d n(kCamera.fx * kSlope.x(), kCamera.fy * kSlope.y(), n_z);
  const Eigen::Vector3d g = T_reference_camera.rotationMatrix() * kCamera.unproject(pixel);
  const Eigen::Vector3d p = T_reference_camera.translation();
  return kCamera.project(p + (1.0 - n.dot(p)) / n.dot(g) * g);
}

ExposureTrajectory trajectory(const SE3& T, const Vector6& xi) { return {T, xi / 0.02, 0.02}; }

struct Scene {
  SE3 T;
  Vector6 xi;
  Eigen::Vector2d anchor;  // less than a pixel from what kPixel sees, as after rounding
  explicit Scene(int seed) {
    test::Random random(static_cast<unsigned>(seed));
    T = random.pose(0.05, 0.05);
    xi = random.tangent(0.01, 0.02);
    PatchPath flat;
    EXPECT_TRUE(makePatchPath(kCamera, kCamera, trajectory(T, xi), kPixel, kInverseDepth, flat));
    anchor = flat.c0.cast<double>() + Eigen::Vector2d(0.4, -0.3);
  }
  PatchPath path(const SE3& T_mid, const Vector6& motion, double inverse_depth) const {
    PatchPath path;
    EXPECT_TRUE(makePatchPath(kCamera, kCamera, trajectory(T_mid, motion), kPixel, inverse_depth, path));
    applySlope(kSlope, anchor, path);
    return path;
  }
};

Eigen::Vector2d positionAt(const PatchPath& path, double u, const Eigen::Vector2d& offset) {
  const auto v = static_cast<float>(u);
  return (path.c0 + v * path.c1 + v * v * path.c2 + (path.A0 + v * path.A1) * offset.cast<float>()).cast<double>();
}

TEST(SlantedPath, MeetsThePlane) {
  for (int seed = 0; seed < 20; ++seed) {
    const Scene scene(seed);
    const PatchPath path = scene.path(scene.T, scene.xi, kInverseDepth);
    const ExposureTrajectory exposure = trajectory(scene.T, scene.xi);
    for (const Eigen::Vector2d& offset : {Eigen::Vector2d(0, 0), Eigen::Vector2d(3, -2), Eigen::Vector2d(-4, 4)}) {
      EXPECT_LT(
          (positionAt(path, 0.0, offset) - intersect(scene.T, kPixel + offset, kInverseDepth, scene.anchor)).norm(),
          0.02);
      EXPECT_LT(
          (positionAt(path, 0.5, offset) - intersect(exposure.end(), kPixel + offset, kInverseDepth, scene.anchor))
              .norm(),
          0.1);
    }
  }
}

TEST(SlantedPath, DerivativesAtMidExposure) {
  constexpr double kStep = 1e-4;
  for (int seed = 0; seed < 20; ++seed) {
    const Scene scene(seed);
    const PatchPath path = scene.path(scene.T, scene.xi, kInverseDepth);
    for (int i = 0; i < 6; ++i) {
      const Vector6 step = kStep * Vector6::Unit(i);
      const Eigen::Vector2d J = (intersect(scene.T * SE3::exp(step), kPixel, kInverseDepth, scene.anchor) -
                                 intersect(scene.T * SE3::exp(-step), kPixel, kInverseDepth, scene.anchor)) /
                                (2.0 * kStep);
      EXPECT_LT((path.J_pose[0].col(i) - J).norm(), 0.02 * (1.0 + J.norm()));
    }
    const Eigen::Vector2d J = (intersect(scene.T, kPixel, kInverseDepth + kStep, scene.anchor) -
                               intersect(scene.T, kPixel, kInverseDepth - kStep, scene.anchor)) /
                              (2.0 * kStep);
    EXPECT_LT((path.J_inverse_depth[0] - J).norm(), 1e-3 * (1.0 + J.norm()));
  }
}

}  // namespace
}  // namespace mba_vo::slanted_path_test
