#include "mba_vo/blur/reblur.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "support/jacobian.h"
#include "support/random.h"

namespace mba_vo::reblur_test {
namespace {

const PinholeCamera kCamera{320, 240, 250.0, 250.0, 159.5, 119.5};

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

double texture(double x, double y) {
  return 120.0 + 60.0 * std::sin(0.055 * x + 0.02 * y) + 50.0 * std::cos(0.04 * y - 0.025 * x);
}

ImageLevel texturedLevel() {
  cv::Mat1f image(kCamera.height, kCamera.width);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) image(y, x) = static_cast<float>(texture(x, y));
  }
  return {image, kCamera};
}

/// Bilinear interpolation and its derivative, in double precision, one sample at a time: what the kernel must sum.
Eigen::Vector3d bilinear(const cv::Mat1f& image, double x, double y) {
  const int ix = static_cast<int>(std::floor(x));
  const int iy = static_cast<int>(std::floor(y));
  const double fx = x - ix;
  const double fy = y - iy;
  const double a = image(iy, ix), b = image(iy, ix + 1), c = image(iy + 1, ix), d = image(iy + 1, ix + 1);
  return {(1 - fy) * ((1 - fx) * a + fx * b) + fy * ((1 - fx) * c + fx * d), (1 - fy) * (b - a) + fy * (d - c),
          (1 - fx) * (c - a) + fx * (d - b)};
}

PatchPath randomPath(test::Random& random) {
  PatchPath path;
  const ExposureTrajectory trajectory{random.pose(0.1, 0.1), random.tangent(1.0, 2.0), 0.02};
  const Eigen::Vector2d pixel(std::floor(random.uniform(80, 240)), std::floor(random.uniform(80, 160)));
  EXPECT_TRUE(makePatchPath(kCamera, kCamera, trajectory, pixel, random.uniform(0.3, 1.0), path));
  return path;
}

TEST(ReblurPatch, EqualsThePlainSumOverSamples) {
  const ImageLevel level = texturedLevel();
  const PatchPattern pattern = PatchPattern::square(9);
  test::Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const PatchPath path = randomPath(random);
    for (const int samples : {1, 2, 7, 16, 33}) {
      ReblurredPatch out;
      reblurPatch(level, path, pattern, samples, out);
      for (std::size_t k = 0; k < static_cast<std::size_t>(pattern.size); ++k) {
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        Eigen::Vector2d mean_u = Eigen::Vector2d::Zero();
        Eigen::Vector2d mean_uu = Eigen::Vector2d::Zero();
        for (int i = 0; i < samples; ++i) {
          const float u = (static_cast<float>(i) + 0.5F) / static_cast<float>(samples) - 0.5F;
          const Eigen::Vector2f offset(static_cast<float>(pattern.dx[k]), static_cast<float>(pattern.dy[k]));
          const Eigen::Vector2f x = path.c0 + u * (path.c1 + u * path.c2) + (path.A0 + u * path.A1) * offset;
          const Eigen::Vector3d s = bilinear(level.intensity, x.x(), x.y()) / samples;
          mean += s;
          mean_u += u * s.tail<2>();
          mean_uu += u * u * s.tail<2>();
        }
        EXPECT_NEAR(out.value[k], mean(0), 2e-3);
        // Gradients jump at pixel borders, where float and double positions may fall on different sides.
        EXPECT_NEAR(out.gx[k], mean(1), 0.1);
        EXPECT_NEAR(out.gy[k], mean(2), 0.1);
        EXPECT_NEAR(out.ugx[k], mean_u(0), 0.05);
        EXPECT_NEAR(out.ugy[k], mean_u(1), 0.05);
        EXPECT_NEAR(out.uugx[k], mean_uu(0), 0.03);
        EXPECT_NEAR(out.uugy[k], mean_uu(1), 0.03);
      }
    }
  }
}

/// Near the sides other code runs, which sees to it that nothing beyond them is read.
TEST(ReblurPatch, NearTheSidesPixelsAreTheSameSumOrInvalid) {
  const ImageLevel level = texturedLevel();
  const PatchPattern pattern = PatchPattern::square(9);
  constexpr int kSamples = 9;
  const Eigen::Vector2f last(static_cast<float>(kCamera.width) - 1.001F, static_cast<float>(kCamera.height) - 1.001F);
  int valid = 0, invalid = 0;
  test::Random random(4);
  for (const Eigen::Vector2f& place : {Eigen::Vector2f(6.3F, 100.2F), Eigen::Vector2f(313.6F, 90.4F),
                                       Eigen::Vector2f(150.7F, 5.1F), Eigen::Vector2f(160.2F, 233.8F)}) {
    PatchPath path = randomPath(random);
    path.c0 = place;
    ReblurredPatch out;
    reblurPatch(level, path, pattern, kSamples, out);
    for (std::size_t k = 0; k < static_cast<std::size_t>(pattern.size); ++k) {
      const Eigen::Vector2f offset(static_cast<float>(pattern.dx[k]), static_cast<float>(pattern.dy[k]));
      double mean = 0.0;
      for (int i = 0; i < kSamples; ++i) {
        const float u = (static_cast<float>(i) + 0.5F) / kSamples - 0.5F;
        const Eigen::Vector2f x = path.c0 + u * (path.c1 + u * path.c2) + (path.A0 + u * path.A1) * offset;
        const bool inside = x.minCoeff() >= 0.0F && (last - x).minCoeff() >= 0.0F;
        mean += inside ? bilinear(level.intensity, x.x(), x.y())(0) / kSamples : std::nan("");
      }
      ASSERT_EQ(std::isnan(out.value[k]), std::isnan(mean)) << place.transpose() << ", " << k;
      ++(std::isnan(mean) ? invalid : valid);
      if (std::isnan(mean)) continue;
      EXPECT_NEAR(out.value[k], mean, 2e-3);
    }
  }
  EXPECT_GT(valid, 50);
  EXPECT_GT(invalid, 50);
}

/// Intensities of the patch as a function of (delta, epsilon, inverse depth), on the smooth texture itself.
TEST(ReblurPatch, MomentsGiveTheDerivativesOfTheBlurredIntensity) {
  const ImageLevel level = texturedLevel();
  const PatchPattern pattern = PatchPattern::square(1);
  constexpr int kSamples = 24;
  test::Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const ExposureTrajectory t{random.pose(0.1, 0.1), random.tangent(1.0, 2.0), 0.02};
    const Eigen::Vector2d pixel(std::floor(random.uniform(100, 220)), std::floor(random.uniform(90, 150)));
    const double inverse_depth = random.uniform(0.4, 1.0);
    const auto intensity = [&](const Eigen::VectorXd& d) {
      double sum = 0.0;
      for (int i = 0; i < kSamples; ++i) {
        const double u = (i + 0.5) / kSamples - 0.5;
        const SE3 T =
            t.T_reference_mid * SE3::exp(Vector6(d.head<6>())) * SE3::exp(u * (t.xi() + Vector6(d.segment<6>(6))));
        const Eigen::Vector2d x = transferPixel(kCamera, kCamera, T, pixel, inverse_depth + d(12)).pixel;
        sum += texture(x.x(), x.y());
      }
      return Eigen::VectorXd::Constant(1, sum / kSamples);
    };
    const Eigen::MatrixXd numeric = test::numericJacobian(intensity, 13);
    PatchPath path;
    ASSERT_TRUE(makePatchPath(kCamera, kCamera, t, pixel, inverse_depth, path));
    ReblurredPatch out;
    reblurPatch(level, path, pattern, kSamples, out);
    const Eigen::RowVector2d g(out.gx[0], out.gy[0]), ug(out.ugx[0], out.ugy[0]), uug(out.uugx[0], out.uugy[0]);
    const Eigen::RowVectorXd J_delta = g * path.J_pose[0] + ug * path.J_pose[1];
    const Eigen::RowVectorXd J_epsilon = ug * path.J_xi[0] + uug * path.J_xi[1];
    const double J_depth = g * path.J_inverse_depth[0] + (ug * path.J_inverse_depth[1])(0);
    const double scale = 3.5 * 250.0;  // largest gradient times focal length
    EXPECT_LT((J_delta - numeric.leftCols<6>()).norm(), 0.03 * scale);
    EXPECT_LT((J_epsilon - numeric.middleCols<6>(6)).norm(), 0.01 * scale);
    EXPECT_NEAR(J_depth, numeric(0, 12), 0.03 * scale * 0.2);
  }
}

TEST(ReblurPatch, LeavingTheReferenceOrTouchingAnInvalidPixelGivesNaN) {
  ImageLevel level = texturedLevel();
  level.intensity(100, 100) = kNaN;
  PatchPath path;
  ASSERT_TRUE(makePatchPath(kCamera, kCamera, ExposureTrajectory{}, {100.0, 100.0}, 1.0, path));
  const PatchPattern pattern = PatchPattern::square(9);
  ReblurredPatch out;
  reblurPatch(level, path, pattern, 1, out);
  int invalid = 0;
  for (std::size_t k = 0; k < 81; ++k) invalid += std::isnan(out.value[k]) ? 1 : 0;
  EXPECT_GE(invalid, 1);
  EXPECT_LE(invalid, 4);
  path.c0 = {-1.0F, 100.0F};
  reblurPatch(level, path, pattern, 1, out);
  for (std::size_t k = 0; k < 81; ++k) EXPECT_EQ(std::isnan(out.value[k]), pattern.dx[k] < 1) << k;
}

TEST(ReblurPatch, MomentsThatAreNotWantedChangeNothingElse) {
  const ImageLevel level = texturedLevel();
  test::Random random(3);
  const PatchPath path = randomPath(random);
  ReblurredPatch all, first, none;
  reblurPatch(level, path, PatchPattern::spread8(), 9, all);
  reblurPatch(level, path, PatchPattern::spread8(), 9, first, GradientMoments::kFirst);
  reblurPatch(level, path, PatchPattern::spread8(), 9, none, GradientMoments::kOmitted);
  for (std::size_t k = 0; k < 8; ++k) {
    EXPECT_FLOAT_EQ(none.value[k], all.value[k]);
    EXPECT_FLOAT_EQ(first.value[k], all.value[k]);
    EXPECT_FLOAT_EQ(first.ugy[k], all.ugy[k]);
  }
}

/// The same path for all pixels of the patch.
PatchPath parallelPath(const Eigen::Vector2f& centre, const Eigen::Vector2f& way) {
  PatchPath path;
  path.c0 = centre;
  path.c1 = way;
  path.c2 = 0.1F * Eigen::Vector2f(-way.y(), way.x());
  path.A0.setIdentity();
  path.A1.setZero();
  return path;
}

TEST(ReblurParallel, IsReblurPatchWhereAllPixelsMoveAlike) {
  ImageLevel level = texturedLevel();
  level.intensity(60, 90) = kNaN;
  const std::vector<PatchPattern> patterns = {PatchPattern::square(1), PatchPattern::square(7), PatchPattern::square(9),
                                              PatchPattern::spread8()};
  const float right = static_cast<float>(kCamera.width - 1);
  // Inside, over an invalid pixel, up to the image's last pixels, and beyond its sides.
  for (const auto& centre :
       {Eigen::Vector2f(150.3F, 100.7F), Eigen::Vector2f(90.2F, 63.9F), Eigen::Vector2f(right - 10.01F, 120.4F),
        Eigen::Vector2f(right - 5.0F, 120.4F), Eigen::Vector2f(8.0F, 3.0F)}) {
    for (const PatchPattern& pattern : patterns) {
      const PatchPath path = parallelPath(centre, {11.3F, -4.1F});
      ReblurredPatch expected;
      reblurPatch(level, path, pattern, 13, expected);
      std::array<float, kMaxPatchPixels> value{};
      reblurParallel(level, path, pattern, 13, value);
      for (std::size_t k = 0; k < static_cast<std::size_t>(pattern.size); ++k) {
        ASSERT_EQ(std::isnan(value[k]), std::isnan(expected.value[k])) << centre.transpose() << ", " << k;
        if (std::isnan(value[k])) continue;
        EXPECT_NEAR(value[k], expected.value[k], 1e-3);
      }
    }
  }
}

TEST(ReblurPatch, AsManyMidpointsAsSampleCountSaysGiveTheIntegral) {
  const ImageLevel level = texturedLevel();
  for (const double length : {10.0, 20.0, 40.0, 80.0}) {  // [px] to the side
    PatchPath path;
    const double rate = length / kCamera.fx / 0.02;
    const ExposureTrajectory t{SE3(), (Vector6() << 0, 0, 0, 0, rate, 0).finished(), 0.02};
    ASSERT_TRUE(makePatchPath(kCamera, kCamera, t, {160.0, 120.0}, 1.0, path));
    ReblurredPatch coarse, fine;
    reblurPatch(level, path, PatchPattern::square(1), sampleCount(path.length(), 1.25F, 64), coarse);
    reblurPatch(level, path, PatchPattern::square(1), 256, fine);
    EXPECT_NEAR(coarse.value[0], fine.value[0], 0.1) << length << " px";
  }
}

}  // namespace
}  // namespace mba_vo::reblur_test
