#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "mba_vo/window/calibration_system.h"
#include "mba_vo/window/window_linearizer.h"
#include "support/jacobian.h"
#include "support/random.h"
#include "window/bilinear_window.h"
#include "window/planar_scene.h"

namespace mba_vo::test::window_jacobian_test {
namespace {

class WindowJacobian : public ::testing::TestWithParam<Exposure> {};
INSTANTIATE_TEST_SUITE_P(SharpBlurredRolling, WindowJacobian,
                         ::testing::Values(Exposure::kSharp, Exposure::kBlurred, Exposure::kBlurredRolling));

// The gradient holds the derivative for the states of hosts and targets alike, each residual with its own random value.
TEST_P(WindowJacobian, GradientMatchesCentralDifferences) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    Random random(seed);
    WindowState state = randomState(random, GetParam());
    const WindowLinearizer linearizer(smoothOptions(), true);
    placePixels(linearizer, state);
    keepCentres(state);
    LinearizedWindow system;
    linearizer.linearize(state, allPoints(state), system);
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < kKeyframeDim; ++i) {
        double side[2];
        for (int s = 0; s < 2; ++s) {
          WindowState moved = state;
          Vector8 step = Vector8::Zero();
          step(i) = (s == 0 ? -1.0 : 1.0) * stepSizes()(i);
          moved.keyframe(k).delta = step;
          side[s] = cost(linearizer, moved);
        }
        const double numeric = (side[1] - side[0]) / (2.0 * stepSizes()(i));
        const double scale = std::sqrt(system.H(kKeyframeDim * k + i, kKeyframeDim * k + i)) * 100.0;
        EXPECT_NEAR(2.0 * system.b(kKeyframeDim * k + i), numeric, 5e-3 * (std::abs(numeric) + scale))
            << "keyframe " << k << " state " << i << " seed " << seed;
      }
    }
    for (int p = 0; p < 10; ++p) {
      double side[2];
      for (int s = 0; s < 2; ++s) {
        WindowState moved = state;
        moved.points[static_cast<std::size_t>(p)].inverse_depth += s == 0 ? -1e-2 : 1e-2;
        side[s] = cost(linearizer, moved);
      }
      const double numeric = (side[1] - side[0]) / 2e-2;
      const double scale = std::sqrt(system.H_depth(p)) * 10.0;
      EXPECT_NEAR(2.0 * system.b_depth(p), numeric, 5e-3 * (std::abs(numeric) + scale)) << "point " << p;
    }
  }
}

// The Hessian against J^T J with J from numerical derivatives of the residual of the centre pixel.
TEST_P(WindowJacobian, HessianIsTheProductOfJacobians) {
  Random random(11);
  const WindowState state = randomState(random, GetParam());
  ResidualOptions options = smoothOptions();
  options.huber_threshold = 1e6F;
  PatchResidual residual;
  const PairGeometry pair = makePairGeometry(state.keyframe(0), state.keyframe(1), true);
  placePixels(pair, {190, 80}, 0.6, options, residual);
  ASSERT_TRUE(residual.has_pixels);
  keepCentre(residual);
  PatchPath path;
  PatchComparison comparison;
  const auto residualAt = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
    KeyframeState moved = state.keyframe(1);
    moved.delta = d.head<8>();
    const PairGeometry p = makePairGeometry(state.keyframe(0), moved, true);
    EXPECT_TRUE(p.path->make(residual.centre.cast<double>(), 0.6 + d(8), path, 80.0));
    EXPECT_TRUE(comparePatch(p, path, residual, options, comparison));
    return Eigen::VectorXd::Constant(1, static_cast<double>(comparison.r[0]));
  };
  const Eigen::MatrixXd J = numericJacobian(residualAt, 9, 5e-3);
  ResidualSystem system;
  ASSERT_TRUE(pair.path->make(residual.centre.cast<double>(), 0.6, path, 80.0));
  ASSERT_TRUE(comparePatch(pair, path, residual, options, comparison));
  assembleSystem(comparison, path, pair.blurred, system);
  Eigen::Matrix<double, 9, 9> H;
  H << system.H, system.H_state_depth, system.H_state_depth.transpose(), system.H_depth;
  const Eigen::Matrix<double, 9, 9> expected = J.transpose() * J;
  const Eigen::Matrix<double, 9, 1> scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((scale.asDiagonal() * (H - expected) * scale.asDiagonal()).cwiseAbs().maxCoeff(), 5e-3);

  const DepthSystem depth = assembleDepth(comparison, path, pair.blurred);
  EXPECT_NEAR(depth.H, system.H_depth, 1e-4 * system.H_depth);
  EXPECT_NEAR(depth.b, system.b_depth, 1e-4 * std::abs(system.b_depth));
}

// Jacobians at the first estimates: the reduced system does not feel a motion of the whole window or its scale there,
// even though the residuals are taken elsewhere.
TEST_P(WindowJacobian, ReducedSystemHasNoInformationAboutTheGauge) {
  Random random(7);
  WindowState state = randomState(random, GetParam());
  for (int k = 0; k < 3; ++k) state.keyframe(k).delta.head<6>() = random.tangent(0.01, 0.01);
  const WindowLinearizer linearizer(smoothOptions(), true);
  placePixels(linearizer, state);
  LinearizedWindow system;
  linearizer.linearize(state, allPoints(state), system);
  ReducedSystem reduced;
  SchurComplement().reduce(system, 0.0, reduced);

  Eigen::MatrixXd gauge = Eigen::MatrixXd::Zero(24, 7);
  for (int k = 0; k < 3; ++k) {
    const SE3& T = state.keyframe(k).T_linear;
    gauge.block<6, 6>(8 * k, 0) = T.inverse().adjoint();
    gauge.block<3, 1>(8 * k, 6) = T.rotation().inverse() * T.translation();
  }
  const double size = reduced.H.norm();
  // The path of a blurred patch contains motion in metres, which does not scale with the window.
  const int directions = GetParam() == Exposure::kSharp ? 7 : 6;
  for (int i = 0; i < directions; ++i) {
    EXPECT_LT((reduced.H * gauge.col(i)).norm(), 1e-12 * size * gauge.col(i).norm()) << "direction " << i;
  }
}

TEST(PhotometricResidual, PixelsOutsideOrInvalidAreNotUsed) {
  Random random(1);
  WindowState state = randomState(random, Exposure::kSharp);
  state.keyframe(1).T_linear = state.keyframe(0).T_linear;
  const PairGeometry pair = makePairGeometry(state.keyframe(0), state.keyframe(1), true);
  PatchResidual residual;
  placePixels(pair, {2, 100}, 0.5, ResidualOptions(), residual);
  EXPECT_FALSE(residual.has_pixels);
  placePixels(pair, {100, 100}, 0.5, ResidualOptions(), residual);
  EXPECT_TRUE(residual.has_pixels);
  EXPECT_EQ(residual.centre, Eigen::Vector2i(100, 100));

  cv::Mat1f holed = state.keyframe(1).original->level(0).intensity.clone();
  holed(102, 100) = std::nanf("");
  state.keyframe(1).original = pyramidOf(holed, smallCamera());
  const PairGeometry holed_pair = makePairGeometry(state.keyframe(0), state.keyframe(1), true);
  placePixels(holed_pair, {100, 100}, 0.5, ResidualOptions(), residual);
  EXPECT_FALSE(residual.has_pixels);
}

// A correction that both images lack moves the place in the host as calibrationJacobian says.
TEST_P(WindowJacobian, OfTheCalibrationIsThatOfALackingCorrection) {
  Random random(23);
  const WindowState state = randomState(random, GetParam());
  for (const PointState& point : state.points) {
    const int target = point.residuals.front().target;
    const Eigen::Vector2i centre(static_cast<int>(random.uniform(40, 280)), static_cast<int>(random.uniform(40, 200)));
    const auto pairWith = [&](const CalibrationCorrection::Vector& lacking) {
      KeyframeState host = state.keyframe(point.host);
      KeyframeState other = state.keyframe(target);
      host.lacking.values = other.lacking.values = lacking;
      return makePairGeometry(host, other, true);
    };
    // Units in which all numbers move the image by about as much.
    CalibrationCorrection::Vector unit;
    unit << 1.0, 1.0, 1.0, 1.0, 1.0, 1e-3, 1.0, 1.0, 1.0;
    const auto place = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
      PatchPath path;
      EXPECT_TRUE(makePath(pairWith(unit.cwiseProduct(d)), centre, point, path));
      return path.c0.cast<double>();
    };
    const Eigen::MatrixXd numeric = numericJacobian(place, CalibrationCorrection::kDim, 5e-3);
    const PairGeometry pair = pairWith(CalibrationCorrection::Vector::Zero());
    PatchPath path;
    ASSERT_TRUE(makeCurrentJacobianPath(pair, centre, point, path));
    const auto J = calibrationJacobian(pair, path, centre.cast<double>(), point.pixel.y());
    const Eigen::MatrixXd analytic = J[0] * unit.asDiagonal();
    EXPECT_LT((analytic - numeric).cwiseAbs().maxCoeff(), 0.02 * (1.0 + numeric.cwiseAbs().maxCoeff()))
        << analytic << "\n\n"
        << numeric;
  }
}

// A vignette that both images lack changes the residual as vignetteJacobian says.
TEST_P(WindowJacobian, OfTheVignetteIsThatOfALackingOne) {
  Random random(37);
  WindowState state = randomState(random, GetParam());
  const WindowLinearizer linearizer(smoothOptions(), true);
  placePixels(linearizer, state);
  int compared = 0;
  for (const PointState& point : state.points) {
    const PatchResidual& residual = point.residuals.front();
    const auto residualsWith = [&](const Eigen::VectorXd& vignette) -> Eigen::VectorXd {
      KeyframeState host = state.keyframe(point.host);
      KeyframeState target = state.keyframe(residual.target);
      host.lacking.values.tail<3>() = target.lacking.values.tail<3>() = vignette;
      const PairGeometry pair = makePairGeometry(host, target, true);
      PatchPath path;
      PatchComparison comparison;
      EXPECT_TRUE(makePath(pair, residual.centre, point, path));
      EXPECT_TRUE(comparePatch(pair, path, residual, smoothOptions(), comparison));
      Eigen::VectorXd r(2 * kResidualPixels);
      for (std::size_t k = 0; k < kResidualPixels; ++k) {
        r(static_cast<Eigen::Index>(k)) = comparison.r[k];
        r(static_cast<Eigen::Index>(k + kResidualPixels)) = -comparison.J_a[k];
      }
      return r;
    };
    const PairGeometry pair = makePairGeometry(state.keyframe(point.host), state.keyframe(residual.target), true);
    PatchPath path;
    if (!residual.has_pixels || !makePath(pair, residual.centre, point, path)) continue;
    const CalibrationCorrection::Vignette by_vignette =
        vignetteJacobian(pair.target_camera, residual.centre.cast<double>()) -
        vignetteJacobian(pair.host_camera, path.c0.cast<double>());
    const Eigen::VectorXd normalized = residualsWith(Eigen::Vector3d::Zero()).tail(kResidualPixels);
    const Eigen::MatrixXd numeric = numericJacobian(residualsWith, 3, 1e-2).topRows(kResidualPixels);
    EXPECT_LT((numeric + normalized * by_vignette.transpose()).cwiseAbs().maxCoeff(), 0.05);
    ++compared;
  }
  EXPECT_GT(compared, 5);
}

}  // namespace
}  // namespace mba_vo::test::window_jacobian_test
