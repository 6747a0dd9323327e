#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "mba_vo/initialization/initializer_structure.h"
#include "mba_vo/initialization/two_view_geometry.h"
#include "support/jacobian.h"
#include "support/random.h"

namespace mba_vo::initializer_geometry_test {
namespace {

const PinholeCamera kCamera{376, 240, 215.0, 215.0, 187.5, 119.5};

enum class Scene { kGeneral, kPlanar };

/// A point cloud in front of a reference, and cameras that move sideways and turn.
struct World {
  World(Scene scene, double translation, double noise_px, unsigned seed, int views = 20, int points = 200,
        double margin = 20.0) {
    test::Random random(seed);
    problem.camera = kCamera;
    for (int p = 0; p < points; ++p) {
      problem.reference_pixels.emplace_back(random.uniform(margin, 375.0 - margin),
                                            random.uniform(margin, 239.0 - margin));
      const Eigen::Vector3d ray = kCamera.unproject(problem.reference_pixels.back());
      const Eigen::Vector3d normal(0.3, 0.2, 1.0);  // of a slanted plane at depth 2 m
      const double plane_w = normal.dot(ray) / 2.0;
      inverse_depth.push_back(scene == Scene::kPlanar ? plane_w : 1.0 / random.uniform(1.0, 4.0));
    }
    for (int v = 0; v < views; ++v) {
      const double s = (v + 1.0) / views;
      Vector6 xi;
      xi << translation * s, -0.5 * translation * s * s, 0.3 * translation * s, 0.05 * s, 0.15 * std::sin(3.0 * s),
          0.02;
      T_view_reference.push_back(SE3::exp(xi));
      addView(random, noise_px);
    }
  }

  void addView(test::Random& random, double noise_px) {
    StructureView view;
    for (std::size_t p = 0; p < inverse_depth.size(); ++p) {
      const Eigen::Vector3d ray = kCamera.unproject(problem.reference_pixels[p]);
      const Eigen::Vector2d pixel = kCamera.project(T_view_reference.back() * (ray / inverse_depth[p]));
      view.pixel.push_back(pixel + Eigen::Vector2d(random.normal(noise_px), random.normal(noise_px)));
      view.tracked.push_back(kCamera.contains(pixel) ? 1 : 0);
    }
    problem.views.push_back(view);
  }

  double medianInverseDepth() const {
    std::vector<double> w = inverse_depth;
    std::nth_element(w.begin(), w.begin() + static_cast<std::ptrdiff_t>(w.size() / 2), w.end());
    return w[w.size() / 2];
  }

  StructureProblem problem;
  std::vector<double> inverse_depth;  // [1/m]
  std::vector<SE3> T_view_reference;
};

Bundle exactBundle(const World& world) {
  Bundle bundle;
  bundle.camera = kCamera;
  for (const Eigen::Vector2d& pixel : world.problem.reference_pixels) bundle.rays.push_back(kCamera.unproject(pixel));
  bundle.inverse_depth = world.inverse_depth;
  for (std::size_t v = 0; v < world.problem.views.size(); ++v) {
    bundle.views.push_back(
        {world.T_view_reference[v], 1.0, world.problem.views[v].pixel, world.problem.views[v].tracked, {}});
  }
  return bundle;
}

TEST(InitializerBundle, JacobiansAgreeWithCentralDifferences) {
  test::Random random(3);
  for (int i = 0; i < 20; ++i) {
    const SE3 T = random.pose(0.5, 0.4);
    const Eigen::Vector3d ray(random.uniform(-0.8, 0.8), random.uniform(-0.5, 0.5), 1.0);
    const double w = random.uniform(0.01, 1.0);
    const Eigen::Vector2d pixel(100.0, 50.0);
    const ReprojectionTerm term = reprojectionTerm(kCamera, T, ray, w, pixel);
    ASSERT_TRUE(term.in_front);
    const auto by_pose = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
      return reprojectionTerm(kCamera, SE3::exp(Vector6(d)) * T, ray, w, pixel).residual;
    };
    const auto by_depth = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
      return reprojectionTerm(kCamera, T, ray, w + d(0), pixel).residual;
    };
    const auto by_ray = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
      return reprojectionTerm(kCamera, T, ray + d, w, pixel).residual;
    };
    EXPECT_LT((test::numericJacobian(by_ray, 3) - term.J_ray).norm(), 1e-5 * (1.0 + term.J_ray.norm()));
    EXPECT_LT((test::numericJacobian(by_pose, 6) - term.J_pose).norm(), 1e-5 * (1.0 + term.J_pose.norm()));
    EXPECT_LT((test::numericJacobian(by_depth, 1) - term.J_inverse_depth).norm(),
              1e-5 * (1.0 + term.J_inverse_depth.norm()));
  }
}

TEST(InitializerBundle, BehindTheCameraIsNotInFront) {
  const SE3 T(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, -2.0));
  EXPECT_FALSE(reprojectionTerm(kCamera, T, Eigen::Vector3d(0.0, 0.0, 1.0), 1.0, Eigen::Vector2d::Zero()).in_front);
}

TEST(InitializerBundle, FindsTheRowTimeThatTracksAreLinearIn) {
  const World world(Scene::kGeneral, 0.15, 0.0, 1, 6, 81, 80.0);
  Bundle bundle = exactBundle(world);
  test::Random random(4);
  for (std::size_t p = 0; p < bundle.rays.size(); ++p) {
    bundle.ray_by_row_time.emplace_back(random.normal(50.0), random.normal(50.0), 0.0);
  }
  for (BundleView& view : bundle.views) {
    for (std::size_t p = 0; p < bundle.rays.size(); ++p) {
      view.pixel_by_row_time.emplace_back(random.normal(1e4), random.normal(1e4));
    }
  }
  const std::vector<Eigen::Vector3d> rays = bundle.rays;
  bundle.setRowTime(1e-4);
  bundle.row_time = 0.0;  // what is right is now at -1e-4
  BundleOptions options;
  options.max_iterations = 30;
  optimizeBundle(bundle, options);
  EXPECT_NEAR(bundle.row_time, -1e-4, 1e-8);
  for (std::size_t p = 0; p < rays.size(); ++p) EXPECT_LT((bundle.rays[p] - rays[p]).norm(), 1e-5);
}

TEST(InitializerBundle, RecoversPosesAndDepthsExactly) {
  const World world(Scene::kGeneral, 0.15, 0.0, 1, 6, 81, 80.0);
  Bundle bundle = exactBundle(world);
  test::Random random(2);
  for (BundleView& view : bundle.views) view.T_view_reference = random.pose(0.03, 0.02) * view.T_view_reference;
  for (double& w : bundle.inverse_depth) w *= random.uniform(0.7, 1.4);
  BundleOptions options;
  options.max_iterations = 60;
  options.relative_decrease = 0.0;
  const BundleSummary summary = optimizeBundle(bundle, options);
  EXPECT_LT(summary.final_cost, 1e-9);
  EXPECT_GT(summary.initial_cost, 1e2);
  normalizeScale(bundle);
  const double scale = world.medianInverseDepth();
  for (std::size_t p = 0; p < bundle.inverse_depth.size(); ++p) {
    EXPECT_NEAR(bundle.inverse_depth[p], world.inverse_depth[p] / scale, 1e-5);
  }
  for (std::size_t v = 0; v < bundle.views.size(); ++v) {
    const SE3& truth = world.T_view_reference[v];
    EXPECT_LT((bundle.views[v].T_view_reference.translation() - scale * truth.translation()).norm(), 1e-5);
    EXPECT_LT(bundle.views[v].T_view_reference.rotation().angularDistance(truth.rotation()), 1e-5);
  }
}

TEST(InitializerBundle, PoseAloneIsRecovered) {
  const World world(Scene::kGeneral, 0.3, 0.0, 4, 2, 80);
  const Bundle bundle = exactBundle(world);
  BundleView view = bundle.views[1];
  view.T_view_reference = SE3::exp(Vector6::Constant(0.03)) * view.T_view_reference;
  BundleOptions options;
  options.max_iterations = 30;
  optimizePose(bundle, view, options);
  EXPECT_LT((view.T_view_reference * world.T_view_reference[1].inverse()).log().norm(), 1e-5);
}

TEST(InitializerBundle, NormalizingTurnsTheMirroredSolutionRoundAndIgnoresUnseenPoints) {
  const World world(Scene::kGeneral, 0.15, 0.0, 5, 3, 61, 80.0);
  Bundle bundle = exactBundle(world);
  for (double& w : bundle.inverse_depth) w *= -3.0;  // (w, t) and (-3 w, -t / 3) make the same images
  for (BundleView& view : bundle.views) {
    view.T_view_reference = SE3(view.T_view_reference.rotation(), -view.T_view_reference.translation() / 3.0);
  }
  for (int i = 0; i < 100; ++i) {  // points that nobody sees
    bundle.rays.emplace_back(0.0, 0.0, 1.0);
    bundle.inverse_depth.push_back(1000.0);
    for (BundleView& view : bundle.views) {
      view.pixel.emplace_back(0.0, 0.0);
      view.observed.push_back(0);
    }
  }
  normalizeScale(bundle);
  EXPECT_NEAR(bundle.inverse_depth[7], world.inverse_depth[7] / world.medianInverseDepth(), 1e-9);
  for (const BundleView& view : bundle.views) {
    for (const double error : reprojectionErrors(bundle, view)) EXPECT_LT(error, 1e-9);
  }
}

TEST(TwoViewGeometry, RotationIsFittedDespiteOutliers) {
  World world(Scene::kGeneral, 0.0, 0.0, 6, 1, 100);
  PixelMatches matches;
  for (std::size_t p = 0; p < 100; ++p) {
    const Eigen::Vector2d wrong(p % 5 == 0 ? 25.0 : 0.0, 0.0);
    matches.add(world.problem.reference_pixels[p], world.problem.views[0].pixel[p] + wrong);
  }
  const RotationFit fit = fitRotation(kCamera, matches, Eigen::Vector3d::Zero(), 20);
  EXPECT_LT((fit.rotation - world.T_view_reference[0].log().tail<3>()).norm(), 5e-4);
  EXPECT_LT(fit.median_residual, 0.2);
}

TEST(TwoViewGeometry, CandidatesContainTheTruth) {
  for (const Scene scene : {Scene::kGeneral, Scene::kPlanar}) {
    const World world(scene, 0.3, 0.0, 7, 1);
    PixelMatches matches;
    for (std::size_t p = 0; p < world.inverse_depth.size(); ++p) {
      if (world.problem.views[0].tracked[p]) {
        matches.add(world.problem.reference_pixels[p], world.problem.views[0].pixel[p]);
      }
    }
    const SE3& truth = world.T_view_reference[0];
    double best = 1e9;
    for (const SE3& T : relativePoseCandidates(kCamera, matches, 1.0)) {
      best = std::min(best, (T.translation() - truth.translation().normalized()).norm() +
                                T.rotation().angularDistance(truth.rotation()));
    }
    EXPECT_LT(best, 0.02) << (scene == Scene::kPlanar ? "planar" : "general");
  }
}

TEST(TwoViewGeometry, NoCandidatesFromTooFewMatches) {
  PixelMatches matches;
  matches.add({10.0, 10.0}, {12.0, 10.0});
  EXPECT_TRUE(relativePoseCandidates(kCamera, matches, 1.0).empty());
}

void expectTruth(const World& world, const StructureEstimate& estimate) {
  ASSERT_TRUE(estimate.accepted) << estimate.reason;
  const double scale = world.medianInverseDepth();
  std::vector<double> errors;
  for (std::size_t p = 0; p < world.inverse_depth.size(); ++p) {
    if (!std::isfinite(estimate.variance[p])) continue;
    errors.push_back(std::abs(estimate.inverse_depth[p] * scale / world.inverse_depth[p] - 1.0));
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.03);
  const double longest = scale * world.T_view_reference.back().translation().norm();
  for (std::size_t v = 0; v < world.T_view_reference.size(); ++v) {
    ASSERT_TRUE(estimate.T_view_reference[v].has_value());
    const SE3& truth = world.T_view_reference[v];
    EXPECT_LT((estimate.T_view_reference[v]->translation() - scale * truth.translation()).norm(), 0.06 * longest);
    EXPECT_LT(estimate.T_view_reference[v]->rotation().angularDistance(truth.rotation()), 0.01);
  }
}

TEST(InitializerStructure, FindsAGeneralScene) {
  for (unsigned seed = 10; seed < 14; ++seed) {
    const World world(Scene::kGeneral, 0.3, 0.3, seed);
    expectTruth(world, estimateStructure(world.problem, StructureConfig()));
  }
}

TEST(InitializerStructure, FindsAPlanarScene) {
  for (unsigned seed = 20; seed < 24; ++seed) {
    const World world(Scene::kPlanar, 0.3, 0.15, seed);
    expectTruth(world, estimateStructure(world.problem, StructureConfig()));
  }
}

TEST(InitializerStructure, FindsASceneDespiteOutliers) {
  World world(Scene::kGeneral, 0.3, 0.2, 30);
  test::Random random(31);
  for (StructureView& view : world.problem.views) {
    for (Eigen::Vector2d& pixel : view.pixel) {
      if (random.uniform(0.0, 1.0) < 0.1) pixel += Eigen::Vector2d(random.uniform(-20, 20), random.uniform(-20, 20));
    }
  }
  expectTruth(world, estimateStructure(world.problem, StructureConfig()));
}

TEST(InitializerStructure, RotationAloneGivesNoMap) {
  const World world(Scene::kGeneral, 0.0, 0.3, 40);
  const StructureEstimate estimate = estimateStructure(world.problem, StructureConfig());
  EXPECT_FALSE(estimate.accepted);
  EXPECT_NE(estimate.reason.find("only rotation so far"), std::string::npos) << estimate.reason;
}

TEST(InitializerStructure, TracksOfDifferentMotionsGiveNoMap) {
  World world(Scene::kGeneral, 0.3, 0.2, 50);
  test::Random random(51);
  for (StructureView& view : world.problem.views) {  // a scene that moves differently in every view
    for (Eigen::Vector2d& pixel : view.pixel) pixel += Eigen::Vector2d(random.normal(4.0), random.normal(4.0));
  }
  EXPECT_FALSE(estimateStructure(world.problem, StructureConfig()).accepted);
}

TEST(InitializerStructure, TooFewViewsAreSaid) {
  const World world(Scene::kGeneral, 0.3, 0.2, 60, 3);
  const StructureEstimate estimate = estimateStructure(world.problem, StructureConfig());
  EXPECT_FALSE(estimate.accepted);
  EXPECT_NE(estimate.reason.find("too few frames"), std::string::npos) << estimate.reason;
}

}  // namespace
}  // namespace mba_vo::initializer_geometry_test
