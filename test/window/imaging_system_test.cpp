#include "mba_vo/window/imaging_system.h"

#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "mba_vo/solver/schur_complement.h"
#include "mba_vo/window/window_optimizer.h"
#include "support/jacobian.h"
#include "support/random.h"
#include "window/bilinear_window.h"
#include "window/planar_scene.h"

namespace mba_vo::test::imaging_system_test {
namespace {

class ImagingSystemOf : public ::testing::TestWithParam<Exposure> {};
INSTANTIATE_TEST_SUITE_P(SharpBlurredRolling, ImagingSystemOf,
                         ::testing::Values(Exposure::kSharp, Exposure::kBlurred, Exposure::kBlurredRolling));

// Whether it finds what is lacking is tested on rendered sequences (odometry/calibration_test.cpp).
TEST_P(ImagingSystemOf, CalibrationIsThatOfASumOfSquares) {
  Random random(29);
  WindowState state = randomState(random, GetParam());
  const WindowLinearizer linearizer(smoothOptions(), true);
  placePixels(linearizer, state);
  const ImagingSystem system = linearizeImaging(state, linearizer, 1);
  const CalibrationCorrection::Matrix& H = system.calibration.H;
  EXPECT_LT((H - H.transpose()).norm(), 1e-6 * H.norm());
  const Eigen::SelfAdjointEigenSolver<CalibrationCorrection::Matrix> eigen(H);
  EXPECT_GT(eigen.eigenvalues().minCoeff(), -1e-6 * eigen.eigenvalues().maxCoeff());
  EXPECT_EQ(system.velocity_steps.size(), GetParam() == Exposure::kBlurredRolling ? 3U : 0U);
}

TEST(ImagingSystem, AWindowWithoutPointsSaysNothing) {
  Random random(1);
  WindowState state = randomState(random, Exposure::kBlurredRolling);
  state.points.clear();
  const ImagingSystem system = linearizeImaging(state, WindowLinearizer(smoothOptions(), true), 1);
  EXPECT_TRUE(system.calibration.H.isZero(0.0));
  EXPECT_TRUE(system.velocity_steps.empty());
}

TEST(ImagingSystem, LargeWindowsSayNoMoreOfTheCalibrationThanOrdinaryOnes) {
  const WindowLinearizer linearizer(smoothOptions(), true);
  const auto evidenceOf = [&](int copies) {  // of 40 points with two residuals each
    Random random(29);
    WindowState state = randomState(random, Exposure::kBlurred);
    placePixels(linearizer, state);
    std::vector<PointState> points;
    for (const PointState& point : state.points) points.insert(points.end(), static_cast<std::size_t>(copies), point);
    state.points = points;
    return refineRowMotions(state, linearizer).H;
  };
  const CalibrationCorrection::Matrix ordinary = evidenceOf(100), large = evidenceOf(400);
  ASSERT_GT(ordinary.trace(), 2.0 * evidenceOf(40).trace());
  EXPECT_LT((large - ordinary).norm(), 1e-3 * ordinary.norm());
}

/// Sharp keyframes with a rolling shutter, rendered row by row, with points at their true depths.
struct RollingWindow {
  static constexpr int kKeyframes = 5;
  static constexpr double kRowTime = 1e-4;  // [s] all rows in 24 ms
  WindowState state;
  std::vector<Vector6> truth;  // the velocities

  explicit RollingWindow(Random& random, double row_time = kRowTime) {
    PinholeCamera camera = smallCamera();
    camera.row_time = row_time;
    const PlanarScene scene = PlanarScene::corner();
    for (int i = 0; i < kKeyframes; ++i) {
      Vector6 place;
      place << 0.06 * i, 0.02 * std::sin(1.1 * i), 0.01 * i, 0.01 * std::sin(0.9 * i), -0.012 * i, 0.005;
      truth.push_back(random.tangent(0.5, 0.6));
      KeyframeState keyframe;
      keyframe.id = static_cast<KeyframeId>(i);
      keyframe.T_linear = SE3::exp(place);
      keyframe.velocity = keyframe.expected_velocity = truth.back();
      keyframe.outlier_energy = 1e5;
      keyframe.original = keyframe.sharp =
          pyramidOf(scene.renderRolling(camera, keyframe.T_linear, truth.back()), camera);
      state.keyframes.push_back(keyframe);
      state.prior.appendKeyframe();
    }
    for (int host = 0; host < kKeyframes; ++host) addPoints(scene, camera, host, random);
  }

  void addPoints(const PlanarScene& scene, const PinholeCamera& camera, int host, Random& random) {
    const KeyframeState& keyframe = state.keyframe(host);
    for (int i = 0; i < 400; ++i) {
      PointState point;
      point.host = host;
      point.pixel = {std::floor(random.uniform(30, 290)), std::floor(random.uniform(20, 220))};
      const SE3 at_row = keyframe.T_linear * SE3::exp(camera.rowDelay(point.pixel.y()) * keyframe.velocity);
      point.inverse_depth = scene.inverseDepth(camera, at_row, point.pixel);
      for (int target = 0; target < kKeyframes; ++target) {
        PatchResidual residual;
        residual.target = target;
        if (target != host) point.residuals.push_back(residual);
      }
      state.points.push_back(point);
    }
  }

  /// By which wrong velocities move a point 2.4 m away, where the wall is, in the last row: root mean square over the
  /// keyframes [px]. What all of them are off by in common hardly shows: rows of host and target are then off alike.
  double error() const {
    const PinholeCamera& camera = state.keyframes.front().original->level(0).camera;
    const Eigen::Vector3d point(0.0, 0.0, 2.4);
    Eigen::Matrix<double, 2, kKeyframes> all;
    for (int i = 0; i < kKeyframes; ++i) {
      const Vector6 wrong = state.keyframe(i).velocity - truth[static_cast<std::size_t>(i)];
      const Eigen::Vector3d moved = wrong.head<3>() + wrong.tail<3>().cross(point);
      all.col(i) = camera.rowDelay(camera.height - 1) * camera.fx * moved.head<2>() / point.z();
    }
    all.colwise() -= all.rowwise().mean().eval();
    return std::sqrt(all.squaredNorm() / kKeyframes);
  }

  void step() {
    const WindowLinearizer linearizer(ResidualOptions(), true);
    placePixels(linearizer, state);
    const ImagingSystem system = linearizeImaging(state, linearizer, 1);
    ASSERT_EQ(system.velocity_steps.size(), state.keyframes.size());
    for (int i = 0; i < kKeyframes; ++i) {
      KeyframeState& keyframe = state.keyframe(i);
      keyframe.setVelocity(keyframe.velocity + system.velocity_steps[static_cast<std::size_t>(i)]);
    }
  }
};

// What was expected is off by up to 0.16 px in the first and last row, and so is its prior; poses and depths are off as
// well.
TEST(ImagingSystem, VelocitiesOfARollingShutterAreFound) {
  Random random(3);
  RollingWindow window(random);
  for (KeyframeState& keyframe : window.state.keyframes) {
    keyframe.velocity = keyframe.expected_velocity = keyframe.velocity + random.tangent(0.05, 0.05);
    if (keyframe.id > 0) keyframe.T_linear = keyframe.T_linear * SE3::exp(random.tangent(5e-4, 5e-4));
  }
  for (PointState& point : window.state.points) point.inverse_depth *= 1.0 + random.uniform(-0.005, 0.005);
  const double before = window.error();
  for (int i = 0; i < 2; ++i) window.step();
  EXPECT_LT(window.error(), 0.45 * before);
}

/// Rows say nothing of velocities that do not move them: what is expected by the frames around is all there is.
TEST(ImagingSystem, VelocitiesStayWhereRowsAreReadAllButAtOnce) {
  for (const double row_time : {1e-8, -1e-7}) {
    Random random(8);
    RollingWindow window(random, row_time);
    for (PointState& point : window.state.points) point.inverse_depth *= 1.0 + random.uniform(-0.005, 0.005);
    window.step();
    for (int i = 0; i < RollingWindow::kKeyframes; ++i) {
      const Vector6 step = window.state.keyframe(i).velocity - window.truth[static_cast<std::size_t>(i)];
      EXPECT_LT(step.norm(), 0.01) << "keyframe " << i << ", rows every " << row_time << " s";
    }
  }
}

// The velocities, which could be otherwise as well, are unknowns of the evidence as they are of the gradient.
TEST(ImagingSystem, EvidenceAndGradientAgreeUnderARollingShutter) {
  constexpr double kWrong = 4e-3;
  for (const int number : {0, 1, 2, 3}) {  // focal length, centre, lens
    const auto systemWith = [&](double lacking) {
      Random random(8);
      RollingWindow window(random);
      for (KeyframeState& keyframe : window.state.keyframes) keyframe.lacking.values(number) = lacking;
      const WindowLinearizer linearizer(ResidualOptions(), true);
      placePixels(linearizer, window.state);
      return linearizeImaging(window.state, linearizer, 1).calibration;
    };
    const CalibrationSystem right = systemWith(0.0), wrong = systemWith(kWrong);
    EXPECT_NEAR((wrong.b(number) - right.b(number)) / right.H(number, number), kWrong, 0.2 * kWrong) << number;
  }
}

/// Rows all at once, the camera turned from keyframe to keyframe, one pixel in eight spoilt, the focal length told
/// wrong by `error`, and everything else where it then fits best.
WindowState windowOfWrongLens(Random& random, double error) {
  RollingWindow window(random, 0.0);
  PinholeCamera told = smallCamera();
  told.fx *= 1.0 + error;
  told.fy *= 1.0 + error;
  WindowState& state = window.state;
  const PlanarScene scene = PlanarScene::corner();
  for (KeyframeState& keyframe : state.keyframes) {
    const auto i = static_cast<double>(keyframe.id);
    Vector6 place;
    place << 0.08 * i, 0.05 * std::sin(1.1 * i), 0.03 * i, 0.04 * std::sin(0.9 * i), -0.05 * i, 0.06 * i;
    keyframe.T_linear = SE3::exp(place);
    keyframe.setVelocity(Vector6::Zero());
    cv::Mat1f image = scene.render(smallCamera(), keyframe.T_linear);
    for (float& value : image)
      value += static_cast<float>(random.normal(random.uniform(0.0, 1.0) < 0.125 ? 12.0 : 1.0));
    keyframe.original = keyframe.sharp = pyramidOf(image, told);
  }
  for (PointState& point : state.points) {
    point.inverse_depth = scene.inverseDepth(smallCamera(), state.keyframe(point.host).T_linear, point.pixel);
  }
  state.prior.addDiagonal(0, Vector8::Constant(1e8), Vector8::Zero());
  ScalePrior scale(1.0);
  scale.choose(state);
  const ResidualOptions options;
  WindowOptimizer optimizer(WindowLinearizer(options, true), static_cast<double>(options.huber_threshold), {});
  optimizer.begin(state, scale, 20);
  while (optimizer.iterate(state, scale)) {
  }
  optimizer.finish(state, scale);
  return state;
}

// One Gauss-Newton step finds 0.62 and 0.69 of it.
TEST(ImagingSystem, AWindowKnowsTheFocalLength) {
  for (const double error : {-0.01, 0.01}) {
    Random random(5);
    WindowState state = windowOfWrongLens(random, error);
    const CalibrationSystem system = linearizeImaging(state, WindowLinearizer(ResidualOptions(), true), 1).calibration;
    const double found = -system.b(CalibrationCorrection::kFocal) / system.H(0, 0);
    EXPECT_NEAR(found / (1.0 / (1.0 + error) - 1.0), 1.0, 0.15) << error;
  }
}

TEST(ImagingSystem, CouplingIsHowGradientsChangeWithTheCorrection) {
  Random random(4);
  RollingWindow window(random);
  const WindowLinearizer linearizer(smoothOptions(), true);
  placePixels(linearizer, window.state);
  std::vector<int> points(window.state.points.size());
  std::iota(points.begin(), points.end(), 0);
  const auto gradient = [&](const Eigen::VectorXd& correction) -> Eigen::VectorXd {
    WindowState state = window.state;
    for (KeyframeState& keyframe : state.keyframes) keyframe.lacking.values = correction;
    LinearizedWindow system;
    linearizer.linearize(state, points, system);
    ReducedSystem reduced;
    SchurComplement().reduce(system, 0.0, reduced);
    return reduced.b;
  };
  const Eigen::MatrixXd numeric = numericJacobian(gradient, CalibrationCorrection::kDim, 3e-4);
  const CalibrationCoupling coupling = calibrationCoupling(window.state, linearizer, points, 1);
  for (int i = 0; i < CalibrationCorrection::kDim; ++i) {
    EXPECT_LT((coupling.col(i) - numeric.col(i)).norm(), 0.15 * numeric.col(i).norm()) << "number " << i;
  }
  const CalibrationCoupling fewer = calibrationCoupling(window.state, linearizer, points, 4);
  EXPECT_LT((fewer - coupling).norm(), 0.4 * coupling.norm());
}

TEST(ImagingSystem, RightVelocitiesStay) {
  Random random(8);
  RollingWindow window(random);
  window.step();
  EXPECT_LT(window.error(), 0.02);
}

}  // namespace
}  // namespace mba_vo::test::imaging_system_test
