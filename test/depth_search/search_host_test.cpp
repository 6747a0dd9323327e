#include "mba_vo/depth_search/search_host.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "depth_search/depth_statistics.h"
#include "depth_search/textured_wall_scene.h"
#include "mba_vo/image/point_selector.h"

namespace mba_vo::search_host_test {
namespace {

using test::DepthStatistics;
using test::PlaneScene;
using test::WaveTexture;

const PinholeCamera kCamera{320, 240, 220.0, 220.0, 159.5, 119.5};
constexpr double kExposure = 0.02;     // [s]
constexpr double kInverseDepth = 0.5;  // of the middle of the scene [1/m]
constexpr double kNoise = 1.0;         // [grey levels]
constexpr int kMoments = 16;           // of a blurred image

Vector6 twist(double x, double y, double z, double rx, double ry, double rz) {
  Vector6 xi;
  xi << x, y, z, rx, ry, rz;
  return xi;
}

ExposureTrajectory during(const SE3& T_mid, const Vector6& xi) { return {T_mid, xi / kExposure, kExposure}; }

/// By which the exposure of a frame with motion `frame` becomes shorter beside a host with `host`.
double restOf(const Vector6& host, const Vector6& frame) {
  return withoutBlurOf({{}, host, kInverseDepth}, during(SE3(), frame)).exposure / kExposure;
}

TEST(SearchHost, TakesItsBlurOffTheFrames) {
  const Vector6 turn = twist(0.0, 0.0, 0.0, 0.0, 0.1, 0.0);
  const Vector6 roll = twist(0.0, 0.0, 0.0, 0.0, 0.0, 0.1);
  EXPECT_EQ(restOf(Vector6::Zero(), turn), 1.0);
  EXPECT_EQ(restOf(roll, turn), 1.0);
  EXPECT_EQ(restOf(turn, turn), 0.0);
  EXPECT_EQ(restOf(2.0 * turn, turn), 0.0);
  EXPECT_NEAR(restOf(0.5 * turn, turn), std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(restOf(-0.5 * turn, turn), std::sqrt(0.75), 1e-12);  // a blur has no direction
  EXPECT_EQ(restOf(turn, Vector6::Zero()), 1.0);
  // 0.2 m are as much as 0.1 rad, 2 m away.
  EXPECT_NEAR(restOf(twist(0.1, 0.0, 0.0, 0.0, 0.0, 0.0), twist(0.2, 0.0, 0.0, 0.0, 0.1, 0.0)), std::sqrt(0.9375),
              1e-12);
}

std::vector<ImmaturePoint> choosePoints(const ImagePyramid& host) {
  std::vector<ImmaturePoint> points;
  for (const Eigen::Vector2i& pixel : selectPoints(host, 500, {})) points.push_back(makeImmaturePoint(host, pixel, {}));
  return points;
}

DepthStatistics searchAll(const PlaneScene& scene, const ImagePyramid& host, const std::vector<ImagePyramid>& frames,
                          const std::vector<ExposureTrajectory>& trajectories, const SearchHost& known) {
  std::vector<ImmaturePoint> points = choosePoints(host);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const DepthSearcher searcher(host, frames[i], trajectories[i], 1.0, 0.0, {}, known);
    for (ImmaturePoint& point : points) searcher.search(point);
  }
  return test::evaluateDepths(scene, points, 0.05);
}

/// Twelve pixels of blur in every image, the host's as well.
TEST(SearchHost, DepthsAreFoundOnASteadyTurn) {
  const PlaneScene scene(kCamera, {{{0.1, 0.03, kInverseDepth}, WaveTexture(21)}});
  const Vector6 xi = twist(0.005, 0.02, 0.0, 0.01, 0.05, 0.02);
  const ImagePyramid host = scene.render(during(SE3(), xi), kMoments, kNoise, 10);
  std::vector<ExposureTrajectory> trajectories;
  std::vector<ImagePyramid> frames;
  for (int i = 1; i <= 3; ++i) {
    trajectories.push_back(during(SE3::exp(1.5 * i * xi), xi));
    frames.push_back(scene.render(trajectories.back(), kMoments, kNoise, 11));
  }
  const DepthStatistics known = searchAll(scene, host, frames, trajectories, {{}, xi, kInverseDepth});
  const DepthStatistics taken_for_sharp =
      searchAll(scene, host, frames, trajectories, {{}, Vector6::Zero(), kInverseDepth});
  EXPECT_GT(known.good, 300);
  EXPECT_GT(known.accurate, 0.95);
  EXPECT_GT(known.good * known.accurate, 1.5 * taken_for_sharp.good * taken_for_sharp.accurate);
}

/// A wall that is 3.3 times nearer than what is known, and moves by 44 px.
TEST(SearchHost, NearThingsAreReached) {
  const PlaneScene scene(kCamera, {{{0.0, 0.0, 1.0 / 0.6}, WaveTexture(22)}});
  const ImagePyramid host = scene.render(during(SE3(), Vector6::Zero()), 1, kNoise, 10);
  const ExposureTrajectory trajectory = during(SE3::exp(twist(0.12, 0.0, 0.0, 0.0, 0.0, 0.0)), Vector6::Zero());
  const ImagePyramid frame = scene.render(trajectory, 1, kNoise, 11);
  const auto found = [&](double inverse_depth) {
    const DepthStatistics s = searchAll(scene, host, {frame}, {trajectory}, {{}, Vector6::Zero(), inverse_depth});
    return s.good * s.accurate;
  };
  EXPECT_GT(found(kInverseDepth), 300);
  EXPECT_EQ(found(0.0), 0);
}

}  // namespace
}  // namespace mba_vo::search_host_test
