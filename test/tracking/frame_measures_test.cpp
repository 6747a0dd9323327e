#include "mba_vo/tracking/frame_measures.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::frame_measures_test {
namespace {

const PinholeCamera kCamera{376, 240, 215.0, 220.0, 187.0, 119.0};

/// Points all over the image at depths from 1 m to 4 m, an odd number of them.
Reference makeReference(unsigned seed) {
  test::Random random(seed);
  Reference reference;
  reference.pyramid = std::make_shared<const ImagePyramid>(cv::Mat1f(240, 376, 100.0F), kCamera, 1);
  for (int i = 0; i < 401; ++i) {
    reference.points.push_back(
        {{static_cast<float>(random.uniform(0, 375)), static_cast<float>(random.uniform(0, 239))},
         static_cast<float>(random.uniform(0.25, 1.0)),
         0.0F});
  }
  return reference;
}

Eigen::Vector2d seenBy(const Eigen::Matrix4d& T_reference_camera, const ReferencePoint& point) {
  Eigen::Matrix3d K;
  K << kCamera.fx, 0, kCamera.cx, 0, kCamera.fy, kCamera.cy, 0, 0, 1;
  const Eigen::Vector3d ray = K.inverse() * Eigen::Vector3d(point.pixel.x(), point.pixel.y(), 1.0);
  const Eigen::Vector3d P = ray / static_cast<double>(point.inverse_depth);
  const Eigen::Vector3d p = (T_reference_camera.inverse() * P.homogeneous()).head<3>();
  return (K * p).hnormalized();
}

Eigen::Matrix4d matrix(const SE3& T) {
  Eigen::Matrix4d M = Eigen::Matrix4d::Identity();
  M.topLeftCorner<3, 3>() = T.rotationMatrix();
  M.topRightCorner<3, 1>() = T.translation();
  return M;
}

TEST(FrameMeasures, AgreeWithDirectComputation) {
  test::Random random(1);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Reference reference = makeReference(seed);
    const ExposureTrajectory trajectory{random.pose(0.2, 0.15), random.tangent(1.0, 2.0), 0.02};
    const Eigen::Matrix4d mid = matrix(trajectory.T_reference_mid);
    Eigen::Matrix4d turned = mid;
    turned.topRightCorner<3, 1>().setZero();
    std::vector<double> blur;
    double flow = 0.0;
    double parallax = 0.0;
    for (const ReferencePoint& point : reference.points) {
      const Eigen::Vector2d pixel = seenBy(mid, point);
      if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() > 375 || pixel.y() > 239) continue;
      flow += (pixel - point.pixel.cast<double>()).squaredNorm();
      parallax += (pixel - seenBy(turned, point)).squaredNorm();
      blur.push_back((seenBy(matrix(trajectory.end()), point) - seenBy(matrix(trajectory.start()), point)).norm());
    }
    std::sort(blur.begin(), blur.end());
    const FrameMeasures measures = measureFrame(reference, trajectory);
    EXPECT_NEAR(measures.flow_px, std::sqrt(flow / static_cast<double>(blur.size())), 1e-6);
    EXPECT_NEAR(measures.parallax_px, std::sqrt(parallax / static_cast<double>(blur.size())), 1e-6);
    EXPECT_NEAR(measures.visible_fraction, static_cast<double>(blur.size()) / 401.0, 1e-9);
    EXPECT_NEAR(measures.blur_length_px, blur[blur.size() / 2], 1e-6);
  }
}

TEST(FrameMeasures, RotationAloneMakesNoParallax) {
  Vector6 turn = Vector6::Zero();
  turn(4) = 0.1;
  const FrameMeasures measures = measureFrame(makeReference(1), {SE3::exp(turn), Vector6::Zero(), 0.0});
  EXPECT_NEAR(measures.parallax_px, 0.0, 1e-9);
  EXPECT_GT(measures.flow_px, 20.0);
  EXPECT_LT(measures.visible_fraction, 1.0);
  EXPECT_EQ(measures.blur_length_px, 0.0);
}

TEST(FrameMeasures, NothingInViewIsNothingVisible) {
  Vector6 turn = Vector6::Zero();
  turn(4) = 3.14;
  EXPECT_EQ(measureFrame(makeReference(1), {SE3::exp(turn), Vector6::Zero(), 0.0}).visible_fraction, 0.0);
  Reference empty = makeReference(1);
  empty.points.clear();
  EXPECT_EQ(measureFrame(empty, {}).visible_fraction, 0.0);
}

}  // namespace
}  // namespace mba_vo::frame_measures_test
