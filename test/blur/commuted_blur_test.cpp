#include "mba_vo/blur/commuted_blur.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::commuted_blur_test {
namespace {

const PinholeCamera kReferenceCamera{320, 240, 250.0, 250.0, 159.5, 119.5};
const PinholeCamera kFrameCamera{320, 240, 240.0, 245.0, 157.0, 121.0};
constexpr double kDepth = 2.0;  // of the textured plane in the reference [m]

/// Light of the plane z = kDepth at (x, y) [m]; the shortest wave is 13 px long.
double texture(double x, double y) {
  return 120.0 + 35.0 * std::sin(35.0 * x + 14.0 * y) + 30.0 * std::cos(42.0 * y - 17.0 * x) +
         25.0 * std::sin(20.0 * (x - y) + 1.0) + 15.0 * std::cos(58.0 * x);
}

/// What a camera sees of the plane while it moves by xi about T_reference_mid, by casting rays.
ImageLevel see(const PinholeCamera& camera, const SE3& T_reference_mid, const Vector6& xi) {
  constexpr int kInstants = 32;
  cv::Mat1d sum(camera.height, camera.width, 0.0);
  for (int i = 0; i < kInstants; ++i) {
    const SE3 T = T_reference_mid * SE3::exp(((i + 0.5) / kInstants - 0.5) * xi);
    const Eigen::Matrix3d R = T.rotationMatrix();
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Eigen::Vector3d ray = R * camera.unproject({x, y});
        const Eigen::Vector3d P = T.translation() + (kDepth - T.translation().z()) / ray.z() * ray;
        sum(y, x) += texture(P.x(), P.y()) / kInstants;
      }
    }
  }
  cv::Mat1f mean;
  sum.convertTo(mean, CV_32F);
  return {mean, camera};
}

struct Difference {
  double mean = 0.0;  // [grey levels]
  double max = 0.0;
  int pixels = 0;
};

/// Reference blurred by `reference_xi`, frame by `frame_xi`: the frame's patches blurred along what is told to be the
/// reference's path, against the reference's patches blurred along the frame's path.
Difference compare(const SE3& T_reference_mid, const Vector6& reference_xi, const Vector6& frame_xi,
                   const Vector6& told_xi) {
  const ImageLevel reference = see(kReferenceCamera, SE3(), reference_xi);
  const ImageLevel frame = see(kFrameCamera, T_reference_mid, frame_xi);
  const CommutedBlur commuted(kReferenceCamera, kFrameCamera, T_reference_mid, told_xi);
  const PatchPattern pattern = PatchPattern::square(9);
  Difference difference;
  for (int y = 50; y <= 190; y += 20) {
    for (int x = 60; x <= 260; x += 20) {
      std::array<float, kMaxPatchPixels> read{};
      commuted.read(frame, {x, y}, 1.0 / kDepth, pattern, 1.0F, 64, read);
      PatchPath path;
      EXPECT_TRUE(
          makePatchPath(kReferenceCamera, kFrameCamera, {T_reference_mid, frame_xi, 1.0}, {x, y}, 1.0 / kDepth, path));
      ReblurredPatch predicted;
      reblurPatch(reference, path, pattern, sampleCount(path.length(), 1.0F, 64), predicted);
      for (std::size_t k = 0; k < static_cast<std::size_t>(pattern.size); ++k) {
        const double d = std::abs(static_cast<double>(read[k] - predicted.value[k]));
        EXPECT_TRUE(std::isfinite(d)) << "at " << x << ", " << y;
        difference.mean += d;
        difference.max = std::max(difference.max, d);
        ++difference.pixels;
      }
    }
  }
  difference.mean /= difference.pixels;
  return difference;
}

TEST(CommutedBlur, BlurringTheFrameAlongTheReferencesPathEqualsReblurringTheReference) {
  test::Random random(1);
  for (int trial = 0; trial < 2; ++trial) {
    const SE3 T_reference_mid = random.pose(0.08, 0.05);
    const Vector6 reference_xi = random.tangent(0.03, 0.035);
    const Vector6 frame_xi = random.tangent(0.03, 0.035);
    const Difference commuted = compare(T_reference_mid, reference_xi, frame_xi, reference_xi);
    const Difference ignored = compare(T_reference_mid, reference_xi, frame_xi, Vector6::Zero());
    EXPECT_LT(commuted.mean, 0.3);
    EXPECT_LT(commuted.max, 2.0);
    EXPECT_LT(commuted.mean, 0.1 * ignored.mean);
  }
}

TEST(CommutedBlur, IsExactForParallelMotionAlongThePlane) {
  // Translation along the plane moves all of the image alike, so both blurs are convolutions, which commute.
  const Vector6 reference_xi = (Vector6() << 0.06, 0.03, 0, 0, 0, 0).finished();
  const Vector6 frame_xi = (Vector6() << -0.02, 0.07, 0, 0, 0, 0).finished();
  const SE3 T_reference_mid(Eigen::Quaterniond::Identity(), {0.05, -0.03, 0.0});
  const Difference commuted = compare(T_reference_mid, reference_xi, frame_xi, reference_xi);
  EXPECT_LT(commuted.max, 1.0);
  EXPECT_GT(compare(T_reference_mid, reference_xi, frame_xi, Vector6::Zero()).max, 5.0);
}

TEST(CommutedBlur, ASharpReferenceLeavesTheFrameAsItIs) {
  test::Random random(2);
  const SE3 T_reference_mid = random.pose(0.1, 0.1);
  const ImageLevel frame = see(kFrameCamera, T_reference_mid, random.tangent(0.02, 0.02));
  const PatchPattern pattern = PatchPattern::square(9);
  for (const double motion : {0.0, 1e-5}) {  // none, and too little to be seen
    const CommutedBlur commuted(kReferenceCamera, kFrameCamera, T_reference_mid, Vector6::Constant(motion));
    std::array<float, kMaxPatchPixels> read{};
    commuted.read(frame, {100, 80}, 0.5, pattern, 1.0F, 64, read);
    for (std::size_t k = 0; k < 81; ++k) EXPECT_EQ(read[k], frame.intensity(80 + pattern.dy[k], 100 + pattern.dx[k]));
  }
}

TEST(CommutedBlur, PixelsThatWouldLookBeyondTheFrameAreInvalid) {
  const Vector6 reference_xi = (Vector6() << 0, 0, 0, 0, 0.08, 0).finished();  // 20 px to the side
  const ImageLevel frame = see(kFrameCamera, SE3(), Vector6::Zero());
  const CommutedBlur commuted(kReferenceCamera, kFrameCamera, SE3(), reference_xi);
  const PatchPattern pattern = PatchPattern::square(9);
  std::array<float, kMaxPatchPixels> read{};
  commuted.read(frame, {5, 100}, 0.5, pattern, 1.0F, 64, read);
  EXPECT_TRUE(std::isnan(read[40]));
  commuted.read(frame, {30, 100}, 0.5, pattern, 1.0F, 64, read);
  for (std::size_t k = 0; k < 81; ++k) EXPECT_TRUE(std::isfinite(read[k]));
  // The point is behind the frame's camera.
  const CommutedBlur behind(kReferenceCamera, kFrameCamera, SE3(Eigen::Quaterniond::Identity(), {0, 0, 5.0}),
                            reference_xi);
  behind.read(frame, {100, 100}, 0.5, pattern, 1.0F, 64, read);
  EXPECT_TRUE(std::isnan(read[40]));
}

}  // namespace
}  // namespace mba_vo::commuted_blur_test
