#include "mba_vo/tracking/quadratic_model.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "mba_vo/solver/robust_loss.h"
#include "support/random.h"

namespace mba_vo::quadratic_model_test {
namespace {

constexpr int kStates = QuadraticModel::kStates;
constexpr int kPixels = 81;
constexpr double kGain = 1.2;
constexpr double kOffset = -3.0;
constexpr double kThreshold = 9.0;

struct Sample {
  ReblurredPatch predicted;
  std::array<float, kMaxPatchPixels> intensity;
  PatchPath path;
};

Sample randomSample(test::Random& random, bool rolling) {
  Sample s;
  const auto fill = [&](std::array<float, kMaxPatchPixels>& row, double size) {
    for (float& value : row) value = static_cast<float>(random.uniform(-size, size));
  };
  fill(s.predicted.value, 50.0);
  for (auto* row :
       {&s.predicted.gx, &s.predicted.gy, &s.predicted.ugx, &s.predicted.ugy, &s.predicted.uugx, &s.predicted.uugy}) {
    fill(*row, 10.0);
  }
  for (std::size_t k = 0; k < s.intensity.size(); ++k) {
    s.intensity[k] = static_cast<float>(kGain * s.predicted.value[k] + kOffset + random.uniform(-20.0, 20.0));
  }
  s.predicted.value[7] = s.intensity[30] = std::numeric_limits<float>::quiet_NaN();
  s.predicted.gx[7] = s.predicted.gy[7] = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 2; ++i) {
    const auto part = static_cast<std::size_t>(i);
    for (int row = 0; row < 2; ++row) {
      s.path.J_pose[part].row(row) = random.tangent(1.0, 1.0).transpose();
      s.path.J_xi[part].row(row) = random.tangent(1.0, 1.0).transpose();
    }
  }
  if (rolling) {
    // As PatchPathMaker has them: that of the middle row, which this row sees later.
    s.path.row = 0.7;
    s.path.c1 << 3.0F, -2.0F;
    s.path.c2 << 0.5F, 0.2F;
    s.path.J_xi_row = s.path.row * s.path.J_xi[0];
    s.path.J_xi[0] += s.path.row * s.path.J_xi[1];
  }
  return s;
}

/// Derivative of the residual of one pixel.
Eigen::Matrix<double, 1, kStates> derivative(const Sample& s, std::size_t k, bool moving) {
  const ReblurredPatch& p = s.predicted;
  const Eigen::RowVector2d g(p.gx[k], p.gy[k]), ug(p.ugx[k], p.ugy[k]), uug(p.uugx[k], p.uugy[k]);
  Eigen::Matrix<double, 1, kStates> J = Eigen::Matrix<double, 1, kStates>::Zero();
  J.head<6>() = -kGain * g * s.path.J_pose[0];
  if (moving) {
    J.head<6>() -= kGain * ug * s.path.J_pose[1];
    J.segment<6>(6) = -kGain * (g * s.path.J_xi_row + ug * s.path.J_xi[0] + uug * s.path.J_xi[1]);
  }
  if (s.path.row != 0.0) {
    // (u + row)^2 / 2 of what the middle row would see, J0 + u J1, without its part in u^3.
    const double row = s.path.row;
    const Matrix26& J1 = s.path.J_xi[1];
    const Matrix26 J0 = s.path.J_xi[0] - row * J1;
    const Eigen::Matrix<double, 1, 6> J_bend =
        0.5 * (row * row * g * J0 + ug * (2.0 * row * J0 + row * row * J1) + uug * (J0 + 2.0 * row * J1));
    J.segment<3>(14) = -kGain * J_bend.tail<3>();
    J(17) = -kGain * (ug * s.path.c1.cast<double>() + 2.0 * uug * s.path.c2.cast<double>()).value();
  }
  J(12) = -kGain * p.value[k];
  J(13) = -1.0;
  return J;
}

void expectSameAsPixelByPixel(bool moving, bool rolling) {
  test::Random random(8);
  QuadraticModel model(3);
  NormalEquations<kStates> expected;
  std::vector<Eigen::Matrix<double, kStates, 1>> patch_gradients;
  PatchWeighting weighting;
  weighting.gain = static_cast<float>(kGain);
  weighting.offset = static_cast<float>(kOffset);
  weighting.huber_threshold = static_cast<float>(kThreshold);
  const HuberLoss loss(kThreshold);
  for (int patch = 0; patch < 3; ++patch) {
    const Sample s = randomSample(random, rolling);
    const PatchSums sums = sumPatch(s.predicted, s.intensity, kPixels, moving, weighting);
    model.cost += sums.cost;
    model.add(sums, s.path, kGain, moving, rolling);
    EXPECT_EQ(sums.pixels, kPixels - 2);
    EXPECT_TRUE(std::isfinite(sums.weighted_squares));
    Eigen::Matrix<double, kStates, 1> gradient = Eigen::Matrix<double, kStates, 1>::Zero();
    for (std::size_t k = 0; k < kPixels; ++k) {
      const double r = s.intensity[k] - (kGain * s.predicted.value[k] + kOffset);
      expected.cost += loss.cost(std::isnan(r) ? kThreshold : r);
      if (std::isnan(r)) continue;
      const Eigen::Matrix<double, 1, kStates> J = derivative(s, k, moving);
      const double weight = std::min(1.0, kThreshold / std::abs(r));
      expected.hessian += weight * J.transpose() * J;
      gradient += weight * r * J.transpose();
    }
    expected.gradient += gradient;
    patch_gradients.push_back(gradient);
  }
  NormalEquations<kStates> equations;
  model.copyTo(equations);
  EXPECT_NEAR(equations.cost, expected.cost, 1e-5 * expected.cost);
  EXPECT_LT((equations.hessian - expected.hessian).norm(), 1e-5 * expected.hessian.norm());
  EXPECT_LT((equations.gradient - expected.gradient).norm(), 1e-5 * expected.gradient.norm());
  const auto found = model.takePatchGradients();
  ASSERT_EQ(found.size(), patch_gradients.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::Map<const Eigen::Matrix<double, kStates, 1>> gradient(found[i].data());
    EXPECT_LT((gradient - patch_gradients[i]).norm(), 1e-5 * patch_gradients[i].norm());
  }
}

TEST(QuadraticModel, OfAMovingPatchIsTheSumOverItsPixels) { expectSameAsPixelByPixel(true, false); }

TEST(QuadraticModel, OfARollingShutterToo) { expectSameAsPixelByPixel(true, true); }

TEST(QuadraticModel, WithoutMotionXiIsNoState) { expectSameAsPixelByPixel(false, false); }

// How robust the estimate is does not change what counts as a good fit.
TEST(QuadraticModel, TheFitIsJudgedByTheInlierThreshold) {
  test::Random random(9);
  const Sample s = randomSample(random, false);
  PatchWeighting weighting;
  weighting.gain = static_cast<float>(kGain);
  weighting.offset = static_cast<float>(kOffset);
  weighting.huber_threshold = 2.0F;
  weighting.inlier_threshold = 12.0F;
  const PatchSums sums = sumPatch(s.predicted, s.intensity, kPixels, true, weighting);
  const HuberLoss loss(12.0);
  int inliers = 0;
  int between = 0;
  double weighted_squares = 0.0;
  for (std::size_t k = 0; k < kPixels; ++k) {
    const double r = s.intensity[k] - (kGain * s.predicted.value[k] + kOffset);
    if (std::isnan(r)) continue;
    inliers += std::abs(r) <= 12.0 ? 1 : 0;
    between += std::abs(r) > 2.0 && std::abs(r) <= 12.0 ? 1 : 0;
    weighted_squares += loss.weight(r) * r * r;
  }
  ASSERT_GT(between, 5);
  ASSERT_LT(inliers, kPixels - 2);
  EXPECT_EQ(sums.inliers, inliers);
  EXPECT_NEAR(sums.weighted_squares, weighted_squares, 1e-5 * weighted_squares);
}

}  // namespace
}  // namespace mba_vo::quadratic_model_test
