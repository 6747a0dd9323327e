#include "mba_vo/window/near_depth_penalty.h"

#include <gtest/gtest.h>

namespace mba_vo::near_depth_penalty_test {
namespace {

WindowState withInverseDepths(const std::vector<double>& inverse_depths) {
  WindowState state;
  for (const double d : inverse_depths) {
    state.points.emplace_back();
    state.points.back().inverse_depth = d;
  }
  return state;
}

LinearizedWindow nothing(Eigen::Index points) {
  LinearizedWindow system;
  system.H_depth = Eigen::VectorXd::Zero(points);
  system.b_depth = Eigen::VectorXd::Zero(points);
  return system;
}

TEST(NearDepthPenalty, IsForMuchNearerPointsAloneAndDoesNotKnowTheUnitOfLength) {
  const NearDepthPenalty prior(withInverseDepths({0.1, 0.5, 3.0}));
  EXPECT_EQ(prior.cost(withInverseDepths({0.001, 0.5, 1.9})), 0.0);
  EXPECT_GT(prior.cost(withInverseDepths({2.1})), 0.0);
  const WindowState state = withInverseDepths({0.3, 0.5, 0.7, 2.0, 5.0});
  WindowState scaled = state;
  for (PointState& point : scaled.points) point.inverse_depth *= 40.0;
  EXPECT_NEAR(NearDepthPenalty(state).cost(state), NearDepthPenalty(scaled).cost(scaled), 1e-9);
}

TEST(NearDepthPenalty, GradientAndHessianAgreeWithDifferencesOfTheCost) {
  const WindowState state = withInverseDepths({0.3, 0.5, 0.7, 2.0, 5.0});
  const NearDepthPenalty prior(state);
  LinearizedWindow system = nothing(5);
  for (std::size_t i = 0; i < state.points.size(); ++i)
    prior.addTo(state.points[i], static_cast<Eigen::Index>(i), system);
  constexpr double kStep = 1e-4;
  for (std::size_t i = 0; i < state.points.size(); ++i) {
    WindowState more = state;
    WindowState less = state;
    more.points[i].inverse_depth += kStep;
    less.points[i].inverse_depth -= kStep;
    const double gradient = (prior.cost(more) - prior.cost(less)) / (2.0 * kStep);
    const double curvature = (prior.cost(more) - 2.0 * prior.cost(state) + prior.cost(less)) / (kStep * kStep);
    const auto row = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(2.0 * system.b_depth(row), gradient, 1e-6 * std::abs(gradient) + 1e-6);
    EXPECT_NEAR(2.0 * system.H_depth(row), curvature, 1e-3 * curvature);
  }
}

TEST(NearDepthPenalty, APointInFrontOfTheLensIsNotPlausible) {
  const NearDepthPenalty prior(withInverseDepths({0.3, 0.5, 0.7, 2.0, 5.0}));
  EXPECT_TRUE(prior.isPlausible(0.001));
  EXPECT_TRUE(prior.isPlausible(5.0));
  EXPECT_FALSE(prior.isPlausible(50.0));
}

TEST(NearDepthPenalty, AWindowWithoutPointsHasNoCost) {
  const WindowState empty = withInverseDepths({});
  EXPECT_EQ(NearDepthPenalty(empty).cost(empty), 0.0);
}

}  // namespace
}  // namespace mba_vo::near_depth_penalty_test
