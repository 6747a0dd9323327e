#include "mba_vo/tracking/alignment_problem.h"

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "smooth_scene.h"
#include "support/jacobian.h"
#include "support/random.h"
#include "support/rendered_room.h"

namespace mba_vo::alignment_problem_test {
namespace {

const PatchPattern kPattern = PatchPattern::square(9);  // the problem keeps a reference to it

AlignmentOptions smoothOptions() {
  AlignmentOptions options;
  options.huber_threshold = 1e4;     // all pixels are inliers
  options.sample_spacing_px = 1e-3;  // so that the number of samples is always max_samples
  options.max_samples = 32;
  return options;
}

/// Of an image by a global shutter neither the bend nor the exposure is a state.
constexpr int kOfGlobalShutter = AlignmentProblem::kStates - 4;

AlignmentState stateAt(test::Random& random) {
  AlignmentState state;
  state.T_reference_mid = random.pose(0.03, 0.02);
  state.xi = random.tangent(0.02, 0.04);
  state.a = random.uniform(-0.2, 0.2);
  state.b = random.uniform(-5.0, 5.0);
  state.bend = random.tangent(0.005, 0.01);
  return state;
}

/// Compares in the unit of the square root of the cost: gradient over the root of the Hessian's diagonal.
/// Returns the size of the numeric one, which must not be small in comparison for all of the states tried.
Eigen::VectorXd expectGradientOfCost(AlignmentProblem& problem, const AlignmentState& state,
                                     int states = kOfGlobalShutter) {
  constexpr double kTolerance = 0.03;  // the path is quadratic in u, its derivatives linear
  const auto equations = problem.linearize(state);
  // Paths have single precision: the exposure, of no unit, takes longer steps to move them by as much.
  AlignmentProblem::Step unit = AlignmentProblem::Step::Ones();
  unit(AlignmentProblem::kLogExposure) = 50.0;
  const auto cost = [&](const Eigen::VectorXd& d) {
    return Eigen::VectorXd::Constant(1, problem.linearize(AlignmentProblem::plus(state, unit.cwiseProduct(d))).cost);
  };
  const Eigen::MatrixXd numeric =
      test::numericJacobian(cost, AlignmentProblem::kStates, 2e-4) * unit.cwiseInverse().asDiagonal();
  for (int i = 0; i < states; ++i) {
    const double scale = std::sqrt(equations.hessian(i, i) * equations.cost);
    EXPECT_NEAR(equations.gradient(i) / scale, numeric(0, i) / scale, kTolerance) << "state " << i;
    EXPECT_GT(equations.hessian(i, i), 0.0) << "state " << i;
  }
  const Eigen::VectorXd size =
      numeric.row(0).transpose().cwiseAbs().cwiseQuotient((equations.cost * equations.hessian.diagonal()).cwiseSqrt());
  return size.head(states);
}

TEST(AlignmentProblem, GradientIsThatOfTheCostForAllStates) {
  const SmoothScene scene = makeScene();
  ASSERT_GT(scene.points.size(), 100U);
  test::Random random(4);
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(kOfGlobalShutter);
  for (const int level : {0, 1}) {
    for (int trial = 0; trial < 4; ++trial) {
      const AlignmentState state = stateAt(random);
      AlignmentProblem problem(*scene.reference, scene.points, *scene.frame, level, kPattern, smoothOptions(),
                               std::nullopt, state);
      largest = largest.cwiseMax(expectGradientOfCost(problem, state));
      const AlignmentStatistics statistics = problem.linearize(state).statistics;
      EXPECT_EQ(statistics.pixels, 81 * problem.patches());
      EXPECT_DOUBLE_EQ(statistics.inlier_fraction, 1.0);
    }
  }
  EXPECT_GT(largest.minCoeff(), 0.1) << largest.transpose();
}

TEST(AlignmentProblem, GradientHoldsWithPriorsAndABlurredReference) {
  test::Random random(5);
  const SmoothScene scene = makeScene(random.tangent(0.01, 0.03));
  AlignmentPrior prior;
  prior.pose_information << 1e6, 2e6, 3e6, 4e6, 5e6, 6e6;
  prior.xi_information << 6e6, 5e6, 4e6, 3e6, 2e6, 1e6;
  for (int trial = 0; trial < 3; ++trial) {
    const AlignmentState state = stateAt(random);
    prior.T_reference_mid = state.T_reference_mid * random.pose(1e-3, 1e-3);
    prior.xi = state.xi + random.tangent(1e-3, 1e-3);
    AlignmentProblem problem(*scene.reference, scene.points, *scene.frame, 0, kPattern, smoothOptions(), prior, state);
    expectGradientOfCost(problem, state);
  }
}

TEST(AlignmentProblem, ThePredictedPoseWeighsByTheResidualsAndTheExpectedXiDoesNot) {
  const SmoothScene scene = makeScene();
  constexpr double kInformation = 1e3;
  test::Random random(9);
  const AlignmentState state = stateAt(random);
  AlignmentPrior prior;
  prior.pose_information.setConstant(kInformation);
  prior.xi_information.setConstant(kInformation);
  prior.T_reference_mid = state.T_reference_mid;
  prior.xi = state.xi;
  AlignmentOptions options = smoothOptions();
  options.residual_sigma = 20.0;
  // What the prior adds to the Hessian, where the residuals spread as far as the threshold says.
  const auto weights = [&](double huber_threshold) {
    const auto hessian = [&](const std::optional<AlignmentPrior>& with) {
      AlignmentProblem problem(*scene.reference, scene.points, *scene.frame, 0, kPattern, options, with, state);
      problem.setHuberThreshold(huber_threshold);
      return problem.linearize(state).hessian;
    };
    const auto difference = (hessian(prior) - hessian(std::nullopt)).eval();
    return Eigen::Vector2d(difference(4, 4), difference(10, 10));
  };
  const double full = kInformation * options.residual_sigma * options.residual_sigma;
  const Eigen::Vector2d sharp = weights(1e4);
  const Eigen::Vector2d blurred = weights(2.0);
  EXPECT_LT((sharp / full - Eigen::Vector2d::Ones()).norm(), 1e-3);
  EXPECT_NEAR(blurred(0) / full, 0.05, 0.01);  // a spread of some 4.5 grey levels instead of 20
  EXPECT_NEAR(blurred(1) / full, 1.0, 1e-3);
}

/// `prior`: for the exposure of the options, while the state has another.
void expectGradientWithARollingShutter(const std::optional<AlignmentPrior>& prior) {
  test::Random random(8);
  const SmoothScene scene = makeScene(Vector6::Zero(), 1e-4);
  scene.reference->motion = {random.tangent(0.3, 0.5), random.tangent(3.0, 5.0)};
  AlignmentOptions options = smoothOptions();
  options.estimate_turn_bend = options.estimate_exposure = true;
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(AlignmentProblem::kStates);
  for (const int level : {0, 1}) {
    for (const double exposure : {0.02, 0.005, 0.02, 0.01, 0.01, 0.02}) {
      options.exposure = exposure;
      AlignmentState state = stateAt(random);
      state.xi = exposure * random.tangent(0.3, 0.5);
      state.bend = exposure * exposure * random.tangent(5.0, 10.0);
      state.log_exposure = random.uniform(-0.3, 0.3);
      AlignmentProblem problem(*scene.reference, scene.points, *scene.frame, level, kPattern, options, prior, state);
      largest = largest.cwiseMax(expectGradientOfCost(problem, state, AlignmentProblem::kStates));
    }
  }
  EXPECT_GT(largest.minCoeff(), 0.1) << largest.transpose();
}

TEST(AlignmentProblem, GradientHoldsWithARollingShutter) {
  expectGradientWithARollingShutter(std::nullopt);
  AlignmentPrior prior;
  prior.xi.setConstant(3e-3);
  prior.xi_information.setConstant(1e6);
  prior.turn_bend_information.setConstant(1e7);
  prior.log_exposure_information = 100.0;
  expectGradientWithARollingShutter(prior);
}

TEST(AlignmentProblem, HessianIsSymmetricAndPredictsTheCostOfSmallSteps) {
  const SmoothScene scene = makeScene();
  test::Random random(6);
  const AlignmentState state = stateAt(random);
  AlignmentProblem problem(*scene.reference, scene.points, *scene.frame, 0, kPattern, smoothOptions(), std::nullopt,
                           state);
  const auto equations = problem.linearize(state);
  EXPECT_LT((equations.hessian - equations.hessian.transpose()).norm(), 1e-9 * equations.hessian.norm());
  Eigen::Matrix<double, AlignmentProblem::kStates, AlignmentProblem::kStates> damped = equations.hessian;
  damped.diagonal() *= 1.0001;
  const AlignmentProblem::Step step = -0.1 * damped.ldlt().solve(equations.gradient);
  const double predicted = equations.gradient.dot(step) + 0.5 * step.dot(equations.hessian * step);
  const double actual = problem.linearize(AlignmentProblem::plus(state, step)).cost - equations.cost;
  EXPECT_LT(predicted, 0.0);
  EXPECT_NEAR(actual, predicted, 0.1 * std::abs(predicted));
}

TEST(AlignmentProblem, CovarianceIsThatOfTheMinimumUnderErrorsThatPatchesShare) {
  // A linear model of patches whose pixels have errors in common, estimated again and again.
  constexpr int kStates = AlignmentProblem::kStates;
  constexpr int kPatches = 150;
  constexpr int kTrials = 400;
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Matrix<double, kStates, 1>> derivatives(kPatches);
  for (auto& J : derivatives) J = J.NullaryExpr([&] { return normal(generator); });
  Eigen::Matrix<double, kStates, 1> predicted = Eigen::Matrix<double, kStates, 1>::Zero();
  Eigen::Matrix<double, kStates, 1> actual = Eigen::Matrix<double, kStates, 1>::Zero();
  for (int trial = 0; trial < kTrials; ++trial) {
    AlignmentProblem::Equations equations;
    for (const auto& J : derivatives) {
      constexpr double kPixels = 20.0;  // all with the same derivative and the same error
      const Eigen::Matrix<double, kStates, 1> gradient = kPixels * normal(generator) * J;
      equations.hessian += kPixels * J * J.transpose();
      equations.gradient += gradient;
      Eigen::Map<Eigen::Matrix<double, kStates, 1>>(equations.patch_gradients.emplace_back().data()) = gradient;
    }
    const Eigen::Matrix<double, kStates, 1> error = equations.hessian.ldlt().solve(equations.gradient);
    actual += error.cwiseAbs2() / kTrials;
    predicted += equations.covariance().diagonal() / kTrials;
  }
  for (int i = 0; i < kStates; ++i) EXPECT_NEAR(predicted(i) / actual(i), 1.0, 0.3);
}

TEST(AlignmentProblem, WithoutExposureXiIsNoState) {
  const SmoothScene scene = makeScene();
  AlignmentOptions options = smoothOptions();
  options.estimate_xi = false;
  test::Random random(7);
  AlignmentState state = stateAt(random);  // at no motion at all, interpolation has kinks
  state.xi.setZero();
  AlignmentProblem problem(*scene.reference, scene.points, *scene.frame, 0, kPattern, options, std::nullopt, state);
  const auto equations = problem.linearize(state);
  EXPECT_EQ(equations.gradient.segment<6>(6).norm(), 0.0);
  EXPECT_TRUE((equations.hessian.block<6, 6>(6, 6).isIdentity()));
  EXPECT_EQ((equations.hessian.block<6, 6>(0, 6).norm()), 0.0);
  // What remains is the same problem as with a motion of zero.
  const auto cost = [&](const Eigen::VectorXd& d) {
    return Eigen::VectorXd::Constant(1, problem.linearize(AlignmentProblem::plus(state, d)).cost);
  };
  const Eigen::MatrixXd numeric = test::numericJacobian(cost, AlignmentProblem::kStates, 2e-4);
  for (const int i : {0, 1, 2, 3, 4, 5, 12, 13}) {
    const double scale = std::sqrt(equations.hessian(i, i) * equations.cost);
    EXPECT_NEAR(equations.gradient(i) / scale, numeric(0, i) / scale, 0.02) << "state " << i;
  }
}

TEST(AlignmentProblem, PatchesAreChosenAnewOnlyAfterALargeMotion) {
  const SmoothScene scene = makeScene();
  const AlignmentState state;
  AlignmentProblem problem(*scene.reference, scene.points, *scene.frame, 0, kPattern, smoothOptions(), std::nullopt,
                           state);
  AlignmentState moved = state;
  Vector6 turn = Vector6::Zero();
  turn(4) = 0.5 / test::roomSimulator().camera().fx;  // half a pixel
  moved.T_reference_mid = SE3::exp(turn);
  EXPECT_FALSE(problem.refresh(moved));
  moved.T_reference_mid = SE3::exp(4.0 * turn);
  EXPECT_TRUE(problem.refresh(moved));
  EXPECT_FALSE(problem.refresh(moved));
}

TEST(AlignmentProblem, TheHuberThresholdFollowsTheResidualsButNotTheOutliers) {
  SmoothScene scene = makeScene();
  AlignmentOptions options;
  const AlignmentState same;  // the frame is the reference, but for the noise
  for (const double sigma : {1.0, 2.5, 20.0}) {
    test::Random random(10);
    cv::Mat1f image = scene.reference->pyramid->level(0).intensity.clone();
    for (float& intensity : image) {
      intensity += static_cast<float>(random.uniform(0.0, 1.0) < 0.15 ? 100.0 : random.normal(sigma));
    }
    auto frame = std::make_shared<Frame>(*scene.frame);
    frame->pyramid = ImagePyramid(image, scene.reference->pyramid->level(0).camera, 1);
    AlignmentProblem problem(*scene.reference, scene.points, *frame, 0, kPattern, options, std::nullopt, same);
    EXPECT_EQ(problem.huberThreshold(), options.huber_threshold);
    problem.followResiduals(same);
    if (sigma > 10.0) {
      EXPECT_EQ(problem.huberThreshold(), options.huber_threshold);
    } else {
      EXPECT_NEAR(problem.huberThreshold(), 2.5 * sigma, 0.3 * 2.5 * sigma);
    }
  }
}

TEST(AlignmentProblem, MaskedPixelsOfTheFrameAreNeitherUsedNorMissed) {
  const SmoothScene scene = makeScene();
  Frame masked = *scene.frame;
  cv::Mat1f image = masked.pyramid.level(0).intensity.clone();
  image(cv::Rect(0, 0, image.cols / 2, image.rows)).setTo(std::nanf(""));
  masked.pyramid = ImagePyramid(image, masked.pyramid.level(0).camera, 1);
  const AlignmentProblem problem(*scene.reference, scene.points, masked, 0, kPattern, smoothOptions(), std::nullopt,
                                 {});
  const AlignmentStatistics statistics = problem.linearize({}).statistics;
  EXPECT_LT(statistics.pixels, 81 * problem.patches());
  EXPECT_DOUBLE_EQ(statistics.inlier_fraction, 1.0);
}

TEST(AlignmentProblem, LeavingTheReferenceNeverPays) {
  // A pose that sees only a part of the reference may not be cheaper than the right one.
  SmoothScene scene = makeScene();
  scene.points.resize(scene.reference->points.size());
  std::iota(scene.points.begin(), scene.points.end(), 0);
  AlignmentOptions options;
  const SE3 truth =
      test::roomSimulator().groundTruth(40).T_world_mid.inverse() * test::roomSimulator().groundTruth(41).T_world_mid;
  const auto cost = [&](double yaw) {
    Vector6 turn = Vector6::Zero();
    turn(4) = yaw;
    AlignmentState state;
    state.T_reference_mid = truth;
    AlignmentProblem problem(*scene.reference, scene.points, *scene.frame, 0, kPattern, options, std::nullopt, state);
    state.T_reference_mid = truth * SE3::exp(turn);
    return problem.linearize(state).cost;
  };
  for (const double yaw : {-1.2, -0.8, -0.4, 0.4, 0.8, 1.2}) EXPECT_GT(cost(yaw), 1.5 * cost(0.0)) << yaw;
}

}  // namespace
}  // namespace mba_vo::alignment_problem_test
