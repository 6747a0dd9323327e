#include "mba_vo/initialization/initializer_rows.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::initializer_rows_test {
namespace {

const PinholeCamera kCamera{376, 240, 215.0, 215.0, 187.5, 119.5};
constexpr double kInterval = 1.0 / 30.0;   // [s] between images
constexpr double kRowTime = 0.02 / 240.0;  // [s]
constexpr int kBefore = 6, kViews = 24;    // images before the reference, and in all
constexpr double kNoise = 0.1;             // [px]

/// A camera in a shaking hand, which walks.
SE3 T_world_camera(double t) {
  Vector6 turn = Vector6::Zero();
  turn.tail<3>() << 0.04 * std::sin(14.0 * t + 0.5), 0.05 * std::sin(19.0 * t), 0.03 * std::sin(11.0 * t);
  const Eigen::Vector3d position(0.4 * t, 0.05 * std::sin(9.0 * t), 0.2 * t);
  return SE3(SE3::exp(turn).rotation(), position);
}

/// Where a camera whose middle row is exposed at t sees a point: its row decides when.
Eigen::Vector2d project(const Eigen::Vector3d& point, double t, double row_time) {
  Eigen::Vector2d pixel(0.0, 119.5);
  for (int i = 0; i < 20; ++i) {
    pixel = kCamera.project(T_world_camera(t + (pixel.y() - 119.5) * row_time).inverse() * point);
  }
  return pixel;
}

struct World {
  World(double row_time, double noise, unsigned seed) {
    test::Random random(seed);
    problem.camera = kCamera;
    for (int p = 0; p < 200; ++p) {
      const Eigen::Vector2d pixel(random.uniform(20.0, 355.0), random.uniform(20.0, 219.0));
      points.push_back(T_world_camera(0.0) * (kCamera.unproject(pixel) * random.uniform(1.0, 4.0)));
      problem.reference_pixels.push_back(project(points.back(), 0.0, row_time));
    }
    for (int v = -kBefore; v < kViews - kBefore; ++v) {
      if (v == 0) continue;
      StructureView view;
      view.time = kInterval * v;
      for (const Eigen::Vector3d& point : points) {
        const Eigen::Vector2d pixel = project(point, view.time, row_time);
        view.pixel.push_back(pixel + Eigen::Vector2d(random.normal(noise), random.normal(noise)));
        view.tracked.push_back(kCamera.contains(pixel) ? 1 : 0);
      }
      problem.views.push_back(view);
    }
  }

  /// By point, at mid-exposure of the reference, in units of their median [1].
  std::vector<double> inverseDepths() const {
    std::vector<double> w;
    for (const Eigen::Vector3d& point : points) w.push_back(1.0 / (T_world_camera(0.0).inverse() * point).z());
    std::vector<double> sorted = w;
    std::sort(sorted.begin(), sorted.end());
    for (double& value : w) value /= sorted[sorted.size() / 2];
    return w;
  }

  StructureProblem problem;
  std::vector<Eigen::Vector3d> points;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Median distance of tracks from where a global shutter would have them [px].
double error(const World& world, const StructureProblem& tracks) {
  std::vector<double> errors;
  for (std::size_t p = 0; p < world.points.size(); ++p) {
    errors.push_back((tracks.reference_pixels[p] - project(world.points[p], 0.0, 0.0)).norm());
    for (const StructureView& view : tracks.views) {
      if (view.tracked[p]) errors.push_back((view.pixel[p] - project(world.points[p], view.time, 0.0)).norm());
    }
  }
  return median(errors);
}

/// Median relative error of the inverse depths, which are in units of their median.
double depthError(const World& world, const StructureEstimate& estimate) {
  const std::vector<double> truth = world.inverseDepths();
  std::vector<double> ratios, errors;
  for (std::size_t p = 0; p < truth.size(); ++p) {
    if (std::isfinite(estimate.variance[p])) ratios.push_back(estimate.inverse_depth[p] / truth[p]);
  }
  const double scale = median(ratios);
  for (const double ratio : ratios) errors.push_back(std::abs(ratio / scale - 1.0));
  return median(errors);
}

StructureEstimate estimate(const World& world, bool find_row_time) {
  StructureConfig config;
  config.find_row_time = find_row_time;
  return estimateStructure(world.problem, config);
}

TEST(InitializerRows, TracksAreTakenToMidExposure) {
  const World world(kRowTime, 0.0, 1);
  EXPECT_GT(error(world, world.problem), 0.5);
  EXPECT_LT(error(world, withGlobalShutter(world.problem, kRowTime)), 0.05);
  EXPECT_GT(error(world, withGlobalShutter(world.problem, 0.5 * kRowTime)), 0.25);
}

TEST(InitializerRows, WithoutRowTimeTracksStay) {
  const World world(0.0, kNoise, 1);
  const StructureProblem same = withGlobalShutter(world.problem, 0.0);
  for (std::size_t v = 0; v < same.views.size(); ++v) {
    for (std::size_t p = 0; p < same.reference_pixels.size(); ++p) {
      if (same.views[v].tracked[p]) {
        EXPECT_LT((same.views[v].pixel[p] - world.problem.views[v].pixel[p]).norm(), 1e-9);
      }
    }
  }
}

TEST(InitializerRows, ATrackThatTooFewImagesHaveIsLeftOut) {
  World world(kRowTime, 0.0, 1);
  for (std::size_t v = 0; v < world.problem.views.size(); ++v) world.problem.views[v].tracked[7] = v == 10 || v == 11;
  const StructureProblem tracks = withGlobalShutter(world.problem, kRowTime);
  for (const StructureView& view : tracks.views) EXPECT_FALSE(view.tracked[7]);
}

TEST(InitializerRows, TheRowTimeIsFoundWithTheStructure) {
  for (const double row_time : {kRowTime, -kRowTime, 0.3 * kRowTime}) {
    const World world(row_time, kNoise, 2);
    const StructureEstimate found = estimate(world, true);
    ASSERT_TRUE(found.accepted) << found.reason;
    EXPECT_NEAR(found.row_time, row_time, 0.05 * kRowTime);
    EXPECT_LT(depthError(world, found), 0.01) << row_time;
  }
}

TEST(InitializerRows, WithoutItTheStructureIsWrong) {
  const World world(kRowTime, kNoise, 2);
  const StructureEstimate wrong = estimate(world, false);
  EXPECT_TRUE(!wrong.accepted || depthError(world, wrong) > 0.03) << depthError(world, wrong);
}

TEST(InitializerRows, ARowTimeThatIsKnownIsUsed) {
  World world(kRowTime, kNoise, 3);
  world.problem.camera.row_time = kRowTime;
  const StructureEstimate told = estimate(world, true);
  ASSERT_TRUE(told.accepted) << told.reason;
  EXPECT_EQ(told.row_time, 0.0);
  EXPECT_LT(depthError(world, told), 0.01);
}

TEST(InitializerRows, AGlobalShutterStaysOne) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const World world(0.0, kNoise, seed);
    const StructureEstimate found = estimate(world, true);
    ASSERT_TRUE(found.accepted) << found.reason;
    EXPECT_EQ(found.row_time, 0.0);
  }
}

}  // namespace
}  // namespace mba_vo::initializer_rows_test
