#include <cmath>

#include <gtest/gtest.h>

#include "mba_vo/window/window_linearizer.h"
#include "support/random.h"
#include "window/bilinear_window.h"

namespace mba_vo::test::zoom_test {
namespace {

/// Two keyframes on one line of sight, the target `nearer` times as near to the point as the host.
bool isCompared(double nearer) {
  Random random(5);
  WindowState state = randomState(random, Exposure::kSharp);
  PointState& point = state.points.front();
  point.residuals = {PatchResidual()};
  point.residuals.front().target = 1;
  point.inverse_depth = 0.5;
  const PinholeCamera camera = state.keyframe(0).camera();
  point.pixel = {std::round(camera.cx), std::round(camera.cy)};
  state.points.resize(1);
  state.keyframe(0).T_linear = SE3();
  state.keyframe(1).T_linear = SE3(SE3().rotation(), Eigen::Vector3d(0.0, 0.0, 2.0 - 2.0 / nearer));
  const WindowLinearizer linearizer(smoothOptions(), true);
  placePixels(linearizer, state);
  WindowEvaluation evaluation;
  linearizer.evaluate(state, allPoints(state), evaluation);
  return !std::isnan(state.points.front().residuals.front().trial_energy);
}

TEST(Zoom, PatchesOfDifferentSizeAreNotCompared) {
  for (const double nearer : {1.0 / 1.4, 1.0, 1.4}) EXPECT_TRUE(isCompared(nearer)) << nearer;
  for (const double nearer : {1.0 / 1.6, 1.6}) EXPECT_FALSE(isCompared(nearer)) << nearer;
}

}  // namespace
}  // namespace mba_vo::test::zoom_test
