#include <array>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "mapping/planar_scene.h"
#include "mba_vo/mapping/calibration_system.h"
#include "mba_vo/mapping/window_linearizer.h"
#include "mba_vo/solver/robust_loss.h"
#include "support/jacobian.h"
#include "support/random.h"

namespace mba_vo {
namespace {

/// I(x, y) = i + j x + k y + l x y: bilinear interpolation and its derivative are exact everywhere.
std::shared_ptr<const ImagePyramid> bilinearImage(test::Random& random, double row_time) {
  PinholeCamera camera = test::smallCamera();
  camera.row_time = row_time;
  const double j = random.uniform(-0.5, 0.5), k = random.uniform(-0.5, 0.5), l = random.uniform(-4e-3, 4e-3);
  cv::Mat1f image(camera.height, camera.width);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image(y, x) = static_cast<float>(100.0 + j * (x - 160.0) + k * (y - 120.0) + l * (x - 160.0) * (y - 120.0));
    }
  }
  return test::pyramidOf(image, camera);
}

enum class Exposure { kSharp, kBlurred, kBlurredRolling };

WindowState randomState(test::Random& random, Exposure exposure) {
  const double row_time = exposure == Exposure::kBlurredRolling ? 1e-4 : 0.0;
  WindowState state;
  for (int i = 0; i < 3; ++i) {
    KeyframeState k;
    k.id = static_cast<KeyframeId>(i);
    k.sharp = bilinearImage(random, row_time);
    k.original = bilinearImage(random, row_time);
    if (exposure != Exposure::kSharp) k.xi = random.tangent(0.03, 0.03);
    if (row_time > 0.0) k.velocity = random.tangent(1.0, 1.0);
    k.T_linear = random.pose(0.15, 0.1);
    k.brightness_linear = {random.uniform(-0.2, 0.2), random.uniform(-10.0, 10.0)};
    k.outlier_energy = 1e12;
    state.keyframes.push_back(k);
    state.prior.appendKeyframe();
  }
  for (int i = 0; i < 40; ++i) {
    PointState point;
    point.host = i % 3;
    point.pixel = {random.uniform(60, 260), random.uniform(60, 180)};
    point.inverse_depth = random.uniform(0.3, 1.0);
    for (int t = 0; t < 3; ++t) {
      PatchResidual residual;
      residual.target = t;
      if (t != point.host) point.residuals.push_back(residual);
    }
    state.points.push_back(point);
  }
  return state;
}

std::vector<int> allPoints(const WindowState& state) {
  std::vector<int> all(state.points.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// Geometric Jacobians are those of the patch's centre, for all its pixels; with only the centre weighted they are
/// exact.
void keepCentre(PatchResidual& residual) {
  residual.weight.fill(0.0F);
  residual.weight[0] = 1.0F;
}

void keepCentres(WindowState& state) {
  for (PointState& point : state.points) {
    for (PatchResidual& residual : point.residuals) keepCentre(residual);
  }
}

double cost(const WindowLinearizer& linearizer, WindowState state) {
  LinearizedWindow system;
  linearizer.linearize(state, allPoints(state), system);
  double sum = 0.0;
  for (const PointState& point : state.points) {
    for (const PatchResidual& residual : point.residuals) {
      if (!std::isnan(residual.trial_energy)) sum += static_cast<double>(residual.trial_energy);
    }
  }
  return sum;
}

/// A step large enough for images in single precision, small enough for central differences.
Vector8 stepSizes() {
  Vector8 h;
  h << Vector6::Constant(2e-3), 2e-3, 0.1;
  return h;
}

/// A fixed number of samples, so that the cost is smooth.
ResidualOptions smoothOptions() {
  ResidualOptions options;
  options.sample_spacing_px = 1e-3F;
  options.max_samples = 16;
  return options;
}

// Residuals into one keyframe are small, those into another large: each gets the threshold that suits it.
TEST(WindowHuberThreshold, FollowsTheResidualsIntoEachKeyframe) {
  const std::array<double, 3> sigma = {1.0, 2.5, 30.0};
  test::Random random(3);
  WindowState state = randomState(random, Exposure::kBlurred);
  const ResidualOptions options = smoothOptions();
  const WindowLinearizer linearizer(options, true);
  linearizer.placePixels(state, 0.75F);
  WindowEvaluation evaluation;
  linearizer.evaluate(state, allPoints(state), evaluation);
  for (std::size_t p = 0; p < state.points.size(); ++p) {
    std::size_t patch = evaluation.first[p];
    for (const PatchResidual& residual : state.points[p].residuals) {
      const bool outlier = random.uniform(0.0, 1.0) < 0.05;
      for (float& r : evaluation.patches[patch].r) {
        r = outlier ? 100.0F : static_cast<float>(random.normal(sigma[static_cast<std::size_t>(residual.target)]));
      }
      ++patch;
    }
  }
  linearizer.followResiduals(state, evaluation);
  const auto threshold = [&](int i) { return static_cast<double>(state.keyframe(i).huber_threshold); };
  for (const int i : {0, 1}) {
    const double expected = 2.5 * sigma[static_cast<std::size_t>(i)];
    EXPECT_NEAR(threshold(i), expected, 0.3 * expected);
  }
  EXPECT_EQ(threshold(2), static_cast<double>(options.huber_threshold));
  const PatchResidual& residual = state.points[2].residuals[0];  // hosted by keyframe 2, into keyframe 0
  ASSERT_EQ(residual.target, 0);
  ASSERT_FALSE(std::isnan(residual.trial_energy));
  double energy = 0.0;
  for (std::size_t k = 0; k < kResidualPixels; ++k) {
    const auto r = static_cast<double>(evaluation.patches[evaluation.first[2]].r[k]);
    energy += 2.0 * static_cast<double>(residual.weight[k]) * HuberLoss(threshold(0)).cost(r);
  }
  EXPECT_NEAR(static_cast<double>(residual.trial_energy), energy, 1e-4 * energy);
}

class WindowJacobian : public ::testing::TestWithParam<Exposure> {};
INSTANTIATE_TEST_SUITE_P(SharpBlurredRolling, WindowJacobian,
                         ::testing::Values(Exposure::kSharp, Exposure::kBlurred, Exposure::kBlurredRolling));

// The gradient holds the derivative for the states of hosts and targets alike, each residual with its own random value.
TEST_P(WindowJacobian, GradientMatchesCentralDifferences) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    test::Random random(seed);
    WindowState state = randomState(random, GetParam());
    const WindowLinearizer linearizer(smoothOptions(), true);
    linearizer.placePixels(state, 0.75F);
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
  test::Random random(11);
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
  const Eigen::MatrixXd J = test::numericJacobian(residualAt, 9, 5e-3);
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
  test::Random random(7);
  WindowState state = randomState(random, GetParam());
  for (int k = 0; k < 3; ++k) state.keyframe(k).delta.head<6>() = random.tangent(0.01, 0.01);
  const WindowLinearizer linearizer(smoothOptions(), true);
  linearizer.placePixels(state, 0.75F);
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
  test::Random random(1);
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
  state.keyframe(1).original = test::pyramidOf(holed, test::smallCamera());
  const PairGeometry holed_pair = makePairGeometry(state.keyframe(0), state.keyframe(1), true);
  placePixels(holed_pair, {100, 100}, 0.5, ResidualOptions(), residual);
  EXPECT_FALSE(residual.has_pixels);
}

// A correction that both images lack moves the place in the host as calibrationJacobian says.
TEST_P(WindowJacobian, OfTheCalibrationIsThatOfALackingCorrection) {
  test::Random random(23);
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
    unit << 1.0, 1.0, 1.0, 1.0, 1.0, 1e-3;
    const auto place = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
      PatchPath path;
      EXPECT_TRUE(makePath(pairWith(unit.cwiseProduct(d)), centre, point, path));
      return path.c0.cast<double>();
    };
    const Eigen::MatrixXd numeric = test::numericJacobian(place, CalibrationCorrection::kDim, 5e-3);
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

// Whether it finds what is lacking is tested on rendered sequences (odometry/calibration_test.cpp).
TEST_P(WindowJacobian, CalibrationSystemIsThatOfASumOfSquares) {
  test::Random random(29);
  WindowState state = randomState(random, GetParam());
  const WindowLinearizer linearizer(smoothOptions(), true);
  linearizer.placePixels(state, 0.75F);
  const CalibrationSystem system = linearizeCalibration(state, linearizer, true, 1);
  EXPECT_LT((system.H - system.H.transpose()).norm(), 1e-6 * system.H.norm());
  const Eigen::SelfAdjointEigenSolver<CalibrationCorrection::Matrix> eigen(system.H);
  EXPECT_GT(eigen.eigenvalues().minCoeff(), -1e-6 * eigen.eigenvalues().maxCoeff());
}

}  // namespace
}  // namespace mba_vo
