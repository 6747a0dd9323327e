#include "mba_vo/image/fov_lens.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mba_vo::fov_lens_test {
namespace {

constexpr double kPi = 3.14159265358979323846;

TEST(FovLens, DistortingAndUndistortingUndoEachOther) {
  for (const double omega : {1e-9, 1e-3, 0.3, 0.93, 1.5, 2.8}) {
    for (double radius = 0.0; radius < 4.0; radius += 0.13) {
      const double distorted = fovDistortedRadius(radius, omega);
      EXPECT_NEAR(fovUndistortedRadius(distorted, omega), radius, 1e-9 * (1.0 + radius)) << omega;
    }
  }
}

/// The inverse by bisection, which knows the forward model only.
TEST(FovLens, TheInverseIsThatWhichIsFoundNumerically) {
  constexpr double kOmega = 0.9332;
  for (double distorted = 0.0; distorted < 1.4; distorted += 0.1) {
    double low = 0.0;
    double high = 100.0;
    for (int i = 0; i < 80; ++i) {
      const double middle = 0.5 * (low + high);
      (fovDistortedRadius(middle, kOmega) > distorted ? high : low) = middle;
    }
    EXPECT_NEAR(fovUndistortedRadius(distorted, kOmega), low, 1e-9 * (1.0 + low));
  }
}

/// A ray at half the field of view omega, at the tangent of which the model is one half by its definition.
TEST(FovLens, TheEdgeOfTheFieldOfViewIsAtRadiusOneHalf) {
  for (const double omega : {0.2, 0.93, 1.5}) {
    EXPECT_NEAR(fovDistortedRadius(0.5, omega), 0.5, 1e-12);
    EXPECT_NEAR(fovUndistortedRadius(0.5, omega), 0.5, 1e-12);
  }
}

TEST(FovLens, WithoutAFieldOfViewItIsAPinhole) {
  EXPECT_EQ(fovDistortedRadius(0.7, 0.0), 0.7);
  EXPECT_EQ(fovUndistortedRadius(0.7, 0.0), 0.7);
  EXPECT_NEAR(fovDistortedRadius(0.7, 2e-6), 0.7, 1e-9);  // and comes near to one gradually
}

TEST(FovLens, NothingIsSeenBehindTheCamera) {
  EXPECT_TRUE(std::isinf(fovUndistortedRadius(0.5 * kPi / 0.9 + 1e-9, 0.9)));
  EXPECT_GT(fovUndistortedRadius(0.5 * kPi / 0.9 - 1e-9, 0.9), 1e6);
}

}  // namespace
}  // namespace mba_vo::fov_lens_test
