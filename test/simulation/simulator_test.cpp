#include "mba_vo/simulation/simulator.h"

#include <gtest/gtest.h>

#include "simulation/test_scenes.h"

namespace mba_vo::simulator_test {
namespace {

bool same(const cv::Mat& a, const cv::Mat& b) { return a.size() == b.size() && cv::countNonZero(a != b) == 0; }

TEST(Simulator, GivesExactMidStartAndEndPoses) {
  const Simulator simulator(smallConfig(), sharedRoom());
  const SimulatedFrame frame = simulator.render(7);
  const double t = 7.0 / 27.0;
  EXPECT_EQ((simulator.pose(t).inverse() * frame.T_world_mid).log().norm(), 0.0);
  EXPECT_EQ((simulator.pose(t - 0.01).inverse() * frame.T_world_start).log().norm(), 0.0);
  EXPECT_EQ((simulator.pose(t + 0.01).inverse() * frame.T_world_end).log().norm(), 0.0);
  EXPECT_GT((frame.T_world_start.inverse() * frame.T_world_end).log().norm(), 1e-3);
  EXPECT_EQ(frame.exposure, 0.02);
  EXPECT_EQ(frame.mid_exposure_ns, 1000259259259LL);
  EXPECT_TRUE(frame.sharp.empty());
  EXPECT_TRUE(frame.depth.empty());
}

TEST(Simulator, SameSeedsGiveTheSameImages) {
  SimulationConfig config = smallConfig();
  const cv::Mat1b image = Simulator(config, sharedRoom()).render(3).blurred;
  EXPECT_TRUE(same(image, Simulator(config).render(3).blurred));
  config.trajectory_seed = 2;
  EXPECT_FALSE(same(image, Simulator(config, sharedRoom()).render(3).blurred));
  config = smallConfig();
  config.scene_seed = 2;
  EXPECT_FALSE(same(image, Simulator(config).render(3).blurred));
}

TEST(Simulator, BlurFiguresMatchAPureRotation) {
  const SimulationConfig config = smallConfig();
  const Simulator simulator(config, sharedRoom());
  const double rate = 0.5;  // about the optical axis [rad/s]
  const PoseFunction roll = [&](double t) {
    Vector6 xi = Vector6::Zero();
    xi(5) = rate * t;
    return SE3(Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.4}) * SE3::exp(xi);
  };
  const SimulatedFrame frame = simulator.renderExposure(roll, 0.0, 0.02);
  double sum = 0.0;  // chord of each pixel's circle
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 188; ++x)
      sum += 2.0 * std::sin(0.005) * std::hypot(x - config.camera().cx, y - config.camera().cy);
  }
  EXPECT_NEAR(frame.blur_px, sum / (120 * 188), 0.02 * frame.blur_px);
}

TEST(Simulator, SharpImageAndDepthOnDemand) {
  SimulationConfig config = smallConfig();
  config.sharp = config.depth = true;
  const Simulator simulator(config, sharedRoom());
  const SimulatedFrame frame = simulator.render(20);
  ASSERT_EQ(frame.sharp.size(), frame.blurred.size());
  ASSERT_EQ(frame.depth.size(), frame.blurred.size());
  double nearest, farthest;
  cv::minMaxLoc(frame.depth, &nearest, &farthest);
  EXPECT_GT(nearest, 0.2);
  EXPECT_LT(farthest, 8.0);
  // A sharp frame without exposure is its own sharp image, but for the noise.
  config.exposure = 0.0;
  config.noise = 0.0;
  const SimulatedFrame still = Simulator(config, sharedRoom()).render(20);
  EXPECT_TRUE(same(still.blurred, still.sharp));
}

TEST(Simulator, DepthPredictsWhereThingsAppearInTheNextImage) {
  SimulationConfig config = smallConfig();
  config.depth = config.sharp = true;
  config.noise = 0.0;
  const Simulator simulator(config, sharedRoom());
  const SimulatedFrame a = simulator.render(40);
  const SimulatedFrame b = simulator.render(42);
  const PinholeCamera camera = simulator.camera();
  const SE3 T_b_a = b.T_world_mid.inverse() * a.T_world_mid;
  double moved = 0.0;
  double kept = 0.0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 188; ++x) {
      const Eigen::Vector2d p = camera.project(T_b_a * (static_cast<double>(a.depth(y, x)) * camera.unproject({x, y})));
      if (!camera.contains(p, 1.0)) continue;
      moved += std::abs(b.sharp(static_cast<int>(p.y() + 0.5), static_cast<int>(p.x() + 0.5)) - a.sharp(y, x));
      kept += std::abs(b.sharp(y, x) - a.sharp(y, x));
    }
  }
  EXPECT_LT(moved, 0.5 * kept);
}

TEST(Simulator, RoomsAreClosedRichAndRoomy) {
  for (const int seed : {1, 5}) {
    SimulationConfig config = smallConfig();
    config.scene_seed = config.trajectory_seed = seed;
    config.duration = 20.0;
    config.noise = 0.0;
    const Simulator simulator(config);
    for (int index = 0; index < simulator.frames(); index += 50) {
      const PoseFunction pose = [&](double t) { return simulator.pose(t); };
      const cv::Mat1f depth = simulator.renderer().depth(pose, simulator.time(index));
      double nearest, farthest;
      cv::minMaxLoc(depth, &nearest, &farthest);
      EXPECT_GT(nearest, 0.25) << "seed " << seed << " frame " << index;  // 0 would be a hole
      cv::Scalar mean, deviation;
      cv::meanStdDev(simulator.renderer().integrate(pose, simulator.time(index), 0.0), mean, deviation);
      EXPECT_GT(deviation[0], 15.0);
      EXPECT_GT(mean[0], 60.0);
      EXPECT_LT(mean[0], 190.0);
    }
  }
}

TEST(Simulator, RefusesFramesOutsideTheSequence) {
  const Simulator simulator(smallConfig(), sharedRoom());
  EXPECT_EQ(simulator.frames(), 271);
  EXPECT_THROW(simulator.render(-1), std::out_of_range);
  EXPECT_THROW(simulator.render(271), std::out_of_range);
}

}  // namespace
}  // namespace mba_vo::simulator_test
