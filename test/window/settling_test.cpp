#include "mba_vo/window/settling.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/random.h"
#include "window/bilinear_window.h"
#include "window/planar_views.h"

namespace mba_vo::test::settling_test {
namespace {

/// How far a point moves in the images of the keyframes that it has residuals in, at most [px].
double largestShift(const WindowState& before, const WindowState& after, std::size_t point) {
  double largest = 0.0;
  for (const PatchResidual& residual : before.points[point].residuals) {
    const auto seen = [&](const WindowState& state) {
      const PointState& p = state.points[point];
      const PairGeometry pair = makePairGeometry(state.keyframe(p.host), state.keyframe(residual.target), true);
      return projectIntoTarget(pair, p.pixel, p.inverse_depth);
    };
    const auto from = seen(before);
    const auto to = seen(after);
    if (from && to) largest = std::max(largest, (*to - *from).norm());
  }
  return largest;
}

struct Moved {
  WindowState before;
  WindowState after;
  Eigen::VectorXd keyframe_steps;
  Eigen::VectorXd depth_steps;

  Moved(Random& random, double translation, double rotation, double depth)
      : before(randomState(random, Exposure::kSharp)),
        after(before),
        keyframe_steps(kKeyframeDim * before.size()),
        depth_steps(static_cast<Eigen::Index>(before.points.size())) {
    for (int i = 0; i < before.size(); ++i) {
      Vector8 step = Vector8::Zero();
      step.head<6>() = random.tangent(translation, rotation);
      after.keyframe(i).delta += step;
      keyframe_steps.segment<kKeyframeDim>(kKeyframeDim * i) = step;
    }
    for (std::size_t i = 0; i < before.points.size(); ++i) {
      const double step = random.normal(depth);
      after.points[i].inverse_depth += step;
      depth_steps(static_cast<Eigen::Index>(i)) = step;
    }
  }

  std::vector<bool> settled(double limit) const {
    return hardlyMove(before, makePairGeometries(before, true), keyframe_steps, depth_steps, limit);
  }
};

TEST(Settling, WhatMovesIsNotedAndWhatDoesNotIsSettled) {
  Random random(1);
  int told_apart = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const double size = random.uniform(0.2, 2.0);
    const Moved moved(random, 4e-4 * size, 2e-4 * size, 5e-4 * size);
    const std::vector<bool> settled = moved.settled(0.1);
    const std::vector<bool> settled_for_more = moved.settled(0.6);
    for (std::size_t i = 0; i < settled.size(); ++i) {
      const double shift = largestShift(moved.before, moved.after, i);
      if (settled[i]) {
        EXPECT_LT(shift, 0.12) << "trial " << trial << ", point " << i;
      }
      // The three ways to move may undo each other; they are told apart within reason nevertheless.
      if (shift < 0.1) {
        EXPECT_TRUE(settled_for_more[i]) << "trial " << trial << ", point " << i << ": " << shift;
      }
      told_apart += settled[i] ? 1 : 0;
    }
  }
  EXPECT_GT(told_apart, 10);
}

TEST(Settling, MovingTogetherIsNotMoving) {
  Random random(2);
  Moved moved(random, 0.0, 0.0, 0.0);
  const Vector6 step = random.tangent(0.05, 0.05);  // of the world
  for (int i = 0; i < moved.before.size(); ++i) {
    const SE3 T = moved.before.keyframe(i).T_map_keyframe();
    moved.keyframe_steps.segment<6>(kKeyframeDim * i) = T.inverse().adjoint() * step;
  }
  for (const bool settled : moved.settled(1e-3)) EXPECT_TRUE(settled);
}

double largestPositionError(const Window& window) {
  std::vector<SE3> estimate;
  for (const KeyframeId id : window.keyframes()) estimate.push_back(window.T_map_keyframe(id));
  const std::vector<double> errors = alignedPositionErrors(views().truth, estimate);
  return *std::max_element(errors.begin(), errors.end());
}

TEST(Settling, NearTheMinimumFewResidualsAreEvaluatedAndItIsFoundAsWell) {
  Window window{WindowConfig()};
  Disturbance near;
  near.pose_noise = 0.2;
  near.depth_noise = 0.005;
  fill(window, keyframesOf(views().sharp, views().sharp, false), near);
  const double before = largestPositionError(window);
  window.optimize(6);
  EXPECT_LT(window.evaluatedResiduals(), window.residualCount() / 4);
  EXPECT_LT(largestPositionError(window), 0.5 * before);
  EXPECT_LT(largestPositionError(window), 1e-3);  // as from far away (window_test)
}

double rmsDepthError(const Window& window) {  // relative
  const Views& v = views();
  double sum = 0.0;
  for (const WindowPoint& p : window.points()) {
    const double truth = v.scene.inverseDepth(v.camera, v.truth[p.host], p.pixel);
    sum += std::pow(p.inverse_depth / truth - 1.0, 2.0);
  }
  return std::sqrt(sum / window.pointCount());
}

TEST(Settling, DepthsOfPointsThatSettleAtOnceAreFoundAndWhatThatGainsCounts) {
  Window window{WindowConfig()};
  Disturbance depths;
  depths.pose_noise = 0.0;
  depths.depth_noise = 0.005;
  fill(window, keyframesOf(views().sharp, views().sharp, false), depths);
  const double before = rmsDepthError(window);
  const WindowSummary summary = window.optimize(4);
  EXPECT_LT(window.evaluatedResiduals(), window.residualCount() / 4);
  EXPECT_LT(rmsDepthError(window), 0.8 * before);
  EXPECT_LT(summary.final_cost, 0.7 * summary.initial_cost);
  EXPECT_LT(summary.final_cost, 1.3 * window.optimize(1).initial_cost) << "with all evaluated anew";
}

TEST(Settling, AWindowAtItsMinimumStaysThere) {
  WindowConfig config;
  config.min_relative_decrease = 0.0;
  Window window(config);
  fill(window, keyframesOf(views().sharp, views().sharp, false), Disturbance());
  window.optimize(30);
  std::vector<SE3> before;
  for (const KeyframeId id : window.keyframes()) before.push_back(window.T_map_keyframe(id));
  const WindowSummary summary = window.optimize(20);
  EXPECT_GT(summary.iterations, 1);
  EXPECT_LT(window.evaluatedResiduals(), window.residualCount() / 4);
  EXPECT_LE(summary.final_cost, summary.initial_cost);
  for (const KeyframeId id : window.keyframes()) {
    EXPECT_LT((before[id].inverse() * window.T_map_keyframe(id)).log().norm(), 8e-5) << "keyframe " << id;
  }
}

}  // namespace
}  // namespace mba_vo::test::settling_test
