#include "mba_vo/window/marginalization_policy.h"

#include <gtest/gtest.h>

namespace mba_vo::marginalization_policy_test {
namespace {

/// Keyframes on a line, all points of each seen by all others.
WindowState windowOf(const std::vector<double>& places, int points_per_keyframe) {
  WindowState state;
  for (const double x : places) {
    KeyframeState keyframe;
    keyframe.id = static_cast<KeyframeId>(state.size());
    keyframe.T_linear = SE3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, 0.0, 0.0));
    keyframe.outlier_energy = 1.0;
    state.keyframes.push_back(keyframe);
  }
  for (int host = 0; host < state.size(); ++host) {
    for (int i = 0; i < points_per_keyframe; ++i) {
      PointState point;
      point.host = host;
      for (int target = 0; target < state.size(); ++target) {
        if (target == host) continue;
        point.residuals.emplace_back();
        point.residuals.back().target = target;
        point.residuals.back().energy = 0.5F;
      }
      state.points.push_back(point);
    }
  }
  return state;
}

std::vector<double> evenly(int n) {
  std::vector<double> places;
  for (int i = 0; i < n; ++i) places.push_back(0.1 * i);
  return places;
}

const MarginalizationPolicyOptions kOptions{10, 5, 1000, 1000, 25.0};

TEST(MarginalizationPolicy, AWindowWithFewResidualsKeepsMoreKeyframes) {
  EXPECT_TRUE(chooseKeyframesToMarginalize(windowOf(evenly(9), 13), kOptions).empty());    // 936 residuals
  EXPECT_EQ(chooseKeyframesToMarginalize(windowOf(evenly(9), 15), kOptions).size(), 1U);   // 1080, with 8 left 840
  EXPECT_EQ(chooseKeyframesToMarginalize(windowOf(evenly(9), 30), kOptions).size(), 3U);   // with 6 left 900
  EXPECT_EQ(chooseKeyframesToMarginalize(windowOf(evenly(12), 1), kOptions).size(), 3U);   // 9 are the most
  EXPECT_EQ(chooseKeyframesToMarginalize(windowOf(evenly(9), 500), kOptions).size(), 5U);  // 4 stay whatever they have
  WindowState bad = windowOf(evenly(9), 30);
  for (PointState& point : bad.points) {
    for (PatchResidual& residual : point.residuals) residual.energy = 2.0F;
  }
  EXPECT_TRUE(chooseKeyframesToMarginalize(bad, kOptions).empty()) << "outliers are no work worth counting";
}

TEST(MarginalizationPolicy, TheOneThatCrowdsTheRestLeavesAndTheNewestTwoStay) {
  const WindowState state = windowOf({0.0, 0.3, 0.6, 0.61, 0.9, 0.91, 1.2}, 0);
  const std::vector<int> marginalized = chooseKeyframesToMarginalize(state, {6, 3, 1000, 1000, 25.0});
  ASSERT_EQ(marginalized.size(), 2U);
  EXPECT_TRUE(marginalized[0] == 2 || marginalized[0] == 3) << marginalized[0];
  for (const int i : marginalized) EXPECT_LT(i, 5);
  EXPECT_TRUE(chooseKeyframesToMarginalize(windowOf({0.0, 0.1}, 9999), {2, 2, 0, 0, 25.0}).empty());
}

TEST(MarginalizationPolicy, OnAFastTurnAndForTenKeyframesAfterItMoreStay) {
  const MarginalizationPolicyOptions options{20, 5, 1000, 2000, 25.0};
  WindowState state = windowOf(evenly(14), 10);  // 1820 residuals
  EXPECT_EQ(chooseKeyframesToMarginalize(state, options).size(), 4U);
  state.keyframe(4).blur_length_px = 24.0;
  EXPECT_EQ(chooseKeyframesToMarginalize(state, options).size(), 4U) << "that is no long blur";
  state.keyframe(3).blur_length_px = 30.0;
  EXPECT_EQ(chooseKeyframesToMarginalize(state, options).size(), 4U) << "ten have come since";
  state.keyframe(4).blur_length_px = 25.0;
  EXPECT_TRUE(chooseKeyframesToMarginalize(state, options).empty());
  EXPECT_EQ(chooseKeyframesToMarginalize(state, {20, 5, 2000, 1000, 25.0}).size(), 0U) << "less would be no use";
  EXPECT_EQ(chooseKeyframesToMarginalize(windowOf(evenly(3), 1), {20, 5, 1000, 2000, 0.0}).size(), 0U);
}

}  // namespace
}  // namespace mba_vo::marginalization_policy_test
