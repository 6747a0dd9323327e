#include "mba_vo/deblur/latent_path.h"

#include <gtest/gtest.h>

namespace mba_vo::latent_path_test {
namespace {

constexpr double kInverseDepth = 0.6;  // [1/m]

/// From one frame to the next, each in a turn of its own.
BlurGeometry nextFrameGeometry(double row_time) {
  BlurGeometry geometry;
  geometry.camera = {376, 240, 260.0, 262.0, 187.0, 119.0};
  geometry.camera.row_time = row_time;
  geometry.latent_camera = geometry.camera;
  geometry.latent_velocity << 0.3, -0.2, 0.1, -1.5, 2.5, 0.6;
  geometry.trajectory.T_reference_mid = SE3::exp((Vector6() << 0.03, -0.02, 0.02, 0.03, -0.04, 0.08).finished());
  geometry.trajectory.velocity << -0.2, 0.4, 0.2, 2.0, 1.0, -0.8;
  geometry.trajectory.exposure = 0.02;
  return geometry;
}

/// Where the pixel of the blurred image looks in the sharp one at `u`, by poses and cameras alone: its ray meets the
/// plane that faces the sharp image's camera when that camera's `row` is exposed, and the point is seen by the row of
/// the sharp image that is exposed when it is there.
Eigen::Vector2d seenAt(const BlurGeometry& geometry, const Eigen::Vector2d& pixel, double u, double row) {
  const PinholeCamera& camera = geometry.camera;
  const auto latentPose = [&](double r) {
    return SE3::exp(geometry.latent_camera.rowDelay(r) * geometry.latent_velocity);
  };
  const SE3 T_plane_camera =
      latentPose(row).inverse() * geometry.trajectory.at(camera.rowDelay(pixel.y()) + u * geometry.trajectory.exposure);
  const Eigen::Vector3d ray = T_plane_camera.rotationMatrix() * camera.unproject(pixel);
  const Eigen::Vector3d origin = T_plane_camera.translation();
  const Eigen::Vector3d point = latentPose(row) * (origin + (1.0 / kInverseDepth - origin.z()) / ray.z() * ray);
  Eigen::Vector2d seen(0.0, row);
  for (int i = 0; i < 50; ++i) seen = geometry.latent_camera.project(latentPose(seen.y()).inverse() * point);
  return seen;
}

void expectThePathsOfTheCameras(const BlurGeometry& geometry) {
  const LatentPathMaker maker(geometry);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(60, 40), Eigen::Vector2d(188, 120), Eigen::Vector2d(300, 210)}) {
    LatentPath seen;
    ASSERT_TRUE(maker.make(pixel, kInverseDepth, seen));
    EXPECT_GT((seen.pixel.cast<double>() - pixel).norm(), 5.0);  // the frames differ, or it proves nothing
    EXPECT_GT(seen.path.length(), 8.0F);
    for (const double u : {-0.5, -0.2, 0.0, 0.3, 0.5}) {
      const auto t = static_cast<float>(u);
      const Eigen::Vector2f found = seen.path.c0 + t * (seen.path.c1 + t * seen.path.c2);
      const Eigen::Vector2d expected = seenAt(geometry, seen.pixel.cast<double>(), u, pixel.y());
      EXPECT_LT((found.cast<double>() - expected).norm(), 0.05) << pixel.transpose() << " at " << u;
    }
    EXPECT_LT((seen.path.c0.cast<double>() - pixel).norm(), 0.01);
  }
}

TEST(LatentPath, IsThatOfPosesAndCameras) { expectThePathsOfTheCameras(nextFrameGeometry(0.0)); }

TEST(LatentPath, FollowsTheRowsOfBothImages) { expectThePathsOfTheCameras(nextFrameGeometry(6e-5)); }

TEST(LatentPath, OfAKeyframeItselfBeginsInItsOwnPixel) {
  BlurGeometry geometry = nextFrameGeometry(6e-5);
  geometry.trajectory.T_reference_mid = SE3();
  geometry.trajectory.velocity = geometry.latent_velocity;
  LatentPath seen;
  ASSERT_TRUE(LatentPathMaker(geometry).make({60, 40}, kInverseDepth, seen));
  EXPECT_LT((seen.pixel - Eigen::Vector2f(60, 40)).norm(), 1e-3F);
}

TEST(LatentPath, BehindACameraThereIsNone) {
  BlurGeometry geometry = nextFrameGeometry(0.0);
  geometry.trajectory.T_reference_mid = SE3::exp((Vector6() << 0, 0, 3.0, 0, 0, 0).finished());
  LatentPath seen;
  EXPECT_FALSE(LatentPathMaker(geometry).make({60, 40}, kInverseDepth, seen));
}

}  // namespace
}  // namespace mba_vo::latent_path_test
