#include "mba_vo/window/gauge_fixing.h"

#include <cmath>

#include <gtest/gtest.h>

#include "mba_vo/geometry/pinhole_camera.h"
#include "support/random.h"

namespace mba_vo::gauge_fixing_test {
namespace {

constexpr int kKeyframes = 4;
constexpr int kPoints = 60;
constexpr double kScale = 1.03;

double distance(const SE3& a, const SE3& b) { return (a.inverse() * b).log().norm(); }

Eigen::Vector3d inMap(const WindowState& state, const PointState& point) {
  return state.keyframe(point.host).T_map_keyframe() * (point.pixel.homogeneous() / point.inverse_depth);
}

/// `pixel` of a point: on the plane z = 1.
WindowState makeState(test::Random& random) {
  WindowState state;
  for (int i = 0; i < kKeyframes; ++i) {
    KeyframeState keyframe;
    keyframe.id = static_cast<KeyframeId>(i);
    keyframe.T_linear = random.pose(1.0, 1.0);
    keyframe.xi = random.tangent(0.01, 0.01);
    state.keyframes.push_back(keyframe);
    state.prior.appendKeyframe();
  }
  for (int i = 0; i < kPoints; ++i) {
    PointState point;
    point.id = static_cast<PointId>(i);
    point.host = i % kKeyframes;
    point.pixel = Eigen::Vector2d(random.normal(0.3), random.normal(0.3));
    point.inverse_depth = 0.5 * std::exp(random.normal(0.2));
    point.information = 1e4;
    state.points.push_back(point);
  }
  return state;
}

/// As an optimisation might: all of it, larger by `scale`.
void moveWhole(WindowState& state, const SE3& motion, double scale) {
  for (KeyframeState& keyframe : state.keyframes) {
    const SE3 T = keyframe.T_map_keyframe();
    keyframe.delta.head<6>() =
        (keyframe.T_linear.inverse() * motion * SE3(T.rotation(), scale * T.translation())).log();
    keyframe.xi.head<3>() *= scale;
  }
  for (PointState& point : state.points) point.inverse_depth /= scale;
}

TEST(GaugeFixing, UndoesWhatMovesTheWholeWindow) {
  test::Random random(1);
  const WindowState before = makeState(random);
  WindowState state = before;
  const GaugeFixing gauge(state);
  moveWhole(state, random.pose(0.1, 0.1), kScale);
  gauge.restore(state);
  for (int i = 0; i < kKeyframes; ++i) {
    EXPECT_LT(distance(state.keyframe(i).T_map_keyframe(), before.keyframe(i).T_map_keyframe()), 1e-9);
    EXPECT_LT((state.keyframe(i).xi - before.keyframe(i).xi).norm(), 1e-12);
  }
  for (std::size_t i = 0; i < kPoints; ++i) {
    EXPECT_NEAR(state.points[i].inverse_depth, before.points[i].inverse_depth, 1e-12);
  }
}

TEST(GaugeFixing, TheNewestKeyframeMayMove) {
  test::Random random(2);
  const WindowState before = makeState(random);
  WindowState state = before;
  const GaugeFixing gauge(state);
  const SE3 correction = random.pose(0.3, 0.3);
  state.keyframes.back().delta.head<6>() = correction.log();
  gauge.restore(state);
  for (int i = 0; i + 1 < kKeyframes; ++i) {
    EXPECT_LT(distance(state.keyframe(i).T_map_keyframe(), before.keyframe(i).T_map_keyframe()), 1e-9);
  }
  const SE3 moved = before.keyframes.back().T_map_keyframe() * correction;
  EXPECT_LT(distance(state.keyframes.back().T_map_keyframe(), moved), 1e-9);
}

TEST(GaugeFixing, ChangesNothingThatImagesSee) {
  test::Random random(3);
  WindowState state = makeState(random);
  const GaugeFixing gauge(state);
  moveWhole(state, random.pose(0.1, 0.1), kScale);
  for (KeyframeState& keyframe : state.keyframes) keyframe.delta.head<6>() += random.tangent(0.01, 0.01);
  for (PointState& point : state.points) point.inverse_depth *= std::exp(random.normal(0.1));
  state.points.erase(state.points.begin() + 5);  // an outlier was removed
  const auto seen = [](const WindowState& s, const PointState& point, int target) {
    const Eigen::Vector3d in_target = s.keyframe(target).T_map_keyframe().inverse() * inMap(s, point);
    return Eigen::Vector2d(in_target.head<2>() / in_target.z());
  };
  const WindowState optimised = state;
  gauge.restore(state);
  EXPECT_GT(distance(state.keyframe(0).T_map_keyframe(), optimised.keyframe(0).T_map_keyframe()), 0.01);
  for (std::size_t i = 0; i < state.points.size(); ++i) {
    for (int target = 0; target < kKeyframes; ++target) {
      EXPECT_LT((seen(state, state.points[i], target) - seen(optimised, optimised.points[i], target)).norm(), 1e-9);
    }
    const double relative = state.points[i].information * std::pow(state.points[i].inverse_depth, 2);
    EXPECT_NEAR(relative, optimised.points[i].information * std::pow(optimised.points[i].inverse_depth, 2), 1e-6);
  }
}

TEST(GaugeFixing, MeasuredDepthsKeepTheirScale) {
  test::Random random(4);
  WindowState state = makeState(random);
  state.points.front().measured = {0.5, 1e-4};
  const GaugeFixing gauge(state);
  moveWhole(state, SE3(), kScale);
  const WindowState optimised = state;
  gauge.restore(state);
  for (std::size_t i = 0; i < kPoints; ++i) {
    EXPECT_EQ(state.points[i].inverse_depth, optimised.points[i].inverse_depth);
  }
}

TEST(GaugeFixing, FirstEstimatesStay) {
  test::Random random(5);
  WindowState state = makeState(random);
  state.prior.connect(1);
  const SE3 first = state.keyframe(1).T_linear;
  const GaugeFixing gauge(state);
  moveWhole(state, random.pose(0.1, 0.1), kScale);
  for (KeyframeState& keyframe : state.keyframes) keyframe.delta.head<6>() += random.tangent(0.01, 0.01);
  gauge.restore(state);
  EXPECT_EQ(distance(state.keyframe(1).T_linear, first), 0.0);
  EXPECT_GT(state.keyframe(1).delta.norm(), 1e-3);
  EXPECT_TRUE(state.keyframe(0).delta.isZero(0.0));
}

}  // namespace
}  // namespace mba_vo::gauge_fixing_test
