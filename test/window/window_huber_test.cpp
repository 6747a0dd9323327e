#include <array>
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "mba_vo/solver/robust_loss.h"
#include "mba_vo/window/window_linearizer.h"
#include "support/random.h"
#include "window/bilinear_window.h"

namespace mba_vo::test::window_huber_test {
namespace {

// Residuals into one keyframe are small, those into another large: each gets the threshold and the weight that suit it.
TEST(WindowHuberThreshold, AndPrecisionFollowTheResidualsIntoEachKeyframe) {
  const std::array<double, 3> sigma = {1.0, 2.5, 30.0};
  Random random(3);
  WindowState state = randomState(random, Exposure::kBlurred);
  const ResidualOptions options = smoothOptions();
  const WindowLinearizer linearizer(options, true);
  placePixels(linearizer, state);
  WindowEvaluation evaluation;
  linearizer.evaluate(state, allPoints(state), evaluation);
  for (std::size_t p = 0; p < state.points.size(); ++p) {
    std::size_t patch = evaluation.first[p];
    for (const PatchResidual& residual : state.points[p].residuals) {
      const bool outlier = random.uniform(0.0, 1.0) < 0.05;
      for (float& r : evaluation.patches[patch].r) {
        r = outlier ? 100.0F : static_cast<float>(random.normal(sigma[static_cast<std::size_t>(residual.target)]));
      }
      ++patch;
    }
  }
  linearizer.followResiduals(state, evaluation);
  const auto threshold = [&](int i) { return static_cast<double>(state.keyframe(i).huber_threshold); };
  for (const int i : {0, 1}) {
    const double expected = 2.5 * sigma[static_cast<std::size_t>(i)];
    EXPECT_NEAR(threshold(i), expected, 0.3 * expected);
  }
  EXPECT_EQ(threshold(2), static_cast<double>(options.huber_threshold));
  const auto precision = [&](int i) { return static_cast<double>(state.keyframe(i).precision); };
  for (const int i : {0, 1, 2}) {
    const double expected = 1.0 / (sigma[static_cast<std::size_t>(i)] * sigma[static_cast<std::size_t>(i)]);
    EXPECT_NEAR(precision(i), expected, 0.6 * expected);
  }
  const PatchResidual& residual = state.points[2].residuals[0];  // hosted by keyframe 2, into keyframe 0
  ASSERT_EQ(residual.target, 0);
  ASSERT_FALSE(std::isnan(residual.trial_energy));
  double energy = 0.0;
  for (std::size_t k = 0; k < kResidualPixels; ++k) {
    const auto r = static_cast<double>(evaluation.patches[evaluation.first[2]].r[k]);
    energy += 2.0 * static_cast<double>(residual.weight[k]) * precision(0) * HuberLoss(threshold(0)).cost(r);
  }
  EXPECT_NEAR(static_cast<double>(residual.trial_energy), energy, 1e-4 * energy);
}

}  // namespace
}  // namespace mba_vo::test::window_huber_test
