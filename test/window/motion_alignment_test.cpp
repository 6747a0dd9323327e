#include "mba_vo/window/motion_alignment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "support/random.h"
#include "window/bilinear_window.h"
#include "window/planar_scene.h"

namespace mba_vo::test::motion_alignment_test {
namespace {

constexpr int kStates = MotionAlignment::kStates;
using Step = Eigen::Matrix<double, kStates, 1>;
constexpr double kExposure = 0.02;  // [s]

class MotionAlignmentJacobian : public ::testing::TestWithParam<Exposure> {};
INSTANTIATE_TEST_SUITE_P(BlurredRolling, MotionAlignmentJacobian,
                         ::testing::Values(Exposure::kBlurred, Exposure::kBlurredRolling));

/// Keyframes whose motions are as expected.
WindowState stateFor(Random& random, Exposure exposure) {
  WindowState state = randomState(random, exposure);
  for (KeyframeState& keyframe : state.keyframes) {
    keyframe.velocity = keyframe.xi / kExposure;
    keyframe.expected_velocity = keyframe.velocity;
    keyframe.outlier_energy = 1e9;
  }
  placePixels(WindowLinearizer(smoothOptions(), true), state);
  keepCentres(state);
  return state;
}

Step numericGradient(const MotionAlignment& problem, const KeyframeMotion& at) {
  Step sizes;
  sizes << stepSizes(), Vector6::Constant(4e-3);
  Step gradient;
  for (int i = 0; i < kStates; ++i) {
    Step step = Step::Zero();
    step(i) = sizes(i);
    const double ahead = problem.linearize(MotionAlignment::plus(at, step)).cost;
    const double behind = problem.linearize(MotionAlignment::plus(at, -step)).cost;
    gradient(i) = (ahead - behind) / (2.0 * sizes(i));
  }
  return gradient;
}

// At the prior's minimum, where it takes no part: it would drown what the images say of xi.
TEST_P(MotionAlignmentJacobian, GradientMatchesCentralDifferences) {
  const ResidualOptions options = smoothOptions();
  for (unsigned seed = 0; seed < 5; ++seed) {
    Random random(seed);
    const WindowState state = stateFor(random, GetParam());
    for (int target = 0; target < 3; ++target) {
      const MotionAlignment problem(state, target, options);
      const Step numeric = numericGradient(problem, problem.initial());
      const Step gradient = problem.linearize(problem.initial()).gradient;
      for (const auto& [first, count] : {std::pair{0, 3}, {3, 3}, {6, 1}, {7, 1}, {8, 3}, {11, 3}}) {
        const double size = numeric.segment(first, count).norm();
        EXPECT_LT((gradient - numeric).segment(first, count).norm(), 3e-2 * size)
            << "states from " << first << " on, of size " << size << ", keyframe " << target << ", seed " << seed;
      }
    }
  }
}

TEST_P(MotionAlignmentJacobian, ThePriorPullsTheMotionBack) {
  const ResidualOptions options = smoothOptions();
  Random random(8);
  const WindowState state = stateFor(random, GetParam());
  const MotionAlignment problem(state, 1, options);
  KeyframeMotion at = problem.initial();
  at.xi += random.tangent(2e-3, 2e-3);
  const Vector6 numeric = numericGradient(problem, at).tail<6>();
  EXPECT_LT((problem.linearize(at).gradient.tail<6>() - numeric).norm(), 2e-2 * numeric.norm());
  EXPECT_GT(numeric.dot(at.xi - problem.initial().xi), 0.0);
}

/// Four keyframes of the analytic scene with true poses and depths; the newest hosts no points.
struct Rendered {
  static constexpr int kKeyframes = 4;
  PinholeCamera camera = smallCamera();
  PlanarScene scene = PlanarScene::corner(0.4);
  WindowState state;
  KeyframeMotion truth;  // of the newest

  explicit Rendered(const Vector6& newest_xi) {
    for (int i = 0; i < kKeyframes; ++i) {
      Vector6 place;
      place << 0.06 * i, 0.02 * std::sin(1.1 * i), 0.01 * i, 0.01 * std::sin(0.9 * i), -0.012 * i, 0.005;
      KeyframeState keyframe;
      keyframe.id = static_cast<KeyframeId>(i);
      keyframe.T_linear = SE3::exp(place);
      keyframe.outlier_energy = 1e5;
      const bool newest = i + 1 == kKeyframes;
      if (newest) {
        keyframe.xi = keyframe.image_xi = newest_xi;
        keyframe.velocity = keyframe.expected_velocity = newest_xi / kExposure;
      }
      keyframe.original = keyframe.sharp =
          pyramidOf(scene.renderBlurred(camera, keyframe.T_linear, keyframe.xi, newest ? 48 : 1), camera);
      state.keyframes.push_back(keyframe);
      state.prior.appendKeyframe();
    }
    for (int host = 0; host + 1 < kKeyframes; ++host) addPoints(host);
    const KeyframeState& newest = state.keyframes.back();
    truth = {newest.T_linear, newest.brightness_linear, newest.xi};
  }

  void addPoints(int host) {
    for (int y = 12; y < camera.height - 12; y += 16) {
      for (int x = 12; x < camera.width - 12; x += 16) {
        PointState point;
        point.host = host;
        point.pixel = {x, y};
        const auto at = [&](double dx, double dy) {
          return scene.inverseDepth(camera, state.keyframe(host).T_linear, {x + dx, y + dy});
        };
        point.inverse_depth = at(0.0, 0.0);
        point.slope = {at(0.5, 0.0) - at(-0.5, 0.0), at(0.0, 0.5) - at(0.0, -0.5)};
        point.residuals.emplace_back();
        point.residuals.back().target = kKeyframes - 1;
        state.points.push_back(point);
      }
    }
  }

  KeyframeMotion newest() const {
    const KeyframeState& keyframe = state.keyframes.back();
    return {keyframe.T_map_keyframe(), keyframe.brightness(), keyframe.xi};
  }
};

Vector6 longBlur() {
  return (Vector6() << 0.02, -0.01, 0.01, 0.03, 0.07, -0.04).finished();  // some 20 px
}

struct Errors {
  double position, rotation, xi_position, xi_rotation;  // [m, rad]
};

/// After the alignment, from a wrong pose and a wrong motion. `expected_right`: the motion by the frames around is
/// right.
Errors errorsAfterAlignment(Random& random, bool expected_right) {
  Rendered rendered(longBlur());
  KeyframeState& newest = rendered.state.keyframes.back();
  newest.T_linear = newest.T_linear * SE3::exp(random.tangent(0.01, 0.004));
  newest.setMotion(newest.xi + random.tangent(0.004, 0.004));
  if (!expected_right) newest.expected_velocity = newest.velocity;
  EXPECT_TRUE(alignNewest(rendered.state, ResidualOptions()));
  EXPECT_EQ(newest.image_xi, newest.xi);
  const KeyframeMotion found = rendered.newest();
  const Vector6 error = (rendered.truth.T_map_keyframe.inverse() * found.T_map_keyframe).log();
  const Vector6 xi_error = found.xi - rendered.truth.xi;
  return {error.head<3>().norm(), error.tail<3>().norm(), xi_error.head<3>().norm(), xi_error.tail<3>().norm()};
}

// From 17 mm and 7 mrad, and a motion wrong by 7 mm and 7 mrad, of which a pixel is 4.
TEST(MotionAlignment, FindsPoseAndMotionOfABlurredKeyframe) {
  Random random(4);
  for (int trial = 0; trial < 8; ++trial) {
    const Errors errors = errorsAfterAlignment(random, trial % 2 == 0);
    EXPECT_LT(errors.position, 2e-3) << trial;
    EXPECT_LT(errors.rotation, 1e-3) << trial;
    EXPECT_LT(errors.xi_position, trial % 2 == 0 ? 5e-3 : 9e-3) << trial;
    EXPECT_LT(errors.xi_rotation, 4e-3) << trial;
  }
}

/// The newest keyframe taken out of the window, as a frame: told wrong, as in errorsAfterAlignment.
KeyframeState asFrame(Rendered& rendered, Random& random) {
  KeyframeState frame = rendered.state.keyframes.back();
  rendered.state.keyframes.pop_back();
  for (PointState& point : rendered.state.points) point.residuals.clear();
  frame.image_xi.setZero();
  frame.setMotion(frame.xi + random.tangent(0.004, 0.004));
  frame.T_linear = frame.T_linear * SE3::exp(random.tangent(0.01, 0.004));
  return frame;
}

TEST(MotionAlignment, FindsPoseAndMotionOfAFrameThatIsNoKeyframe) {
  Random random(5);
  for (int trial = 0; trial < 4; ++trial) {
    Rendered rendered(longBlur());
    const KeyframeState frame = asFrame(rendered, random);
    const auto found = alignFrame(rendered.state, frame, ResidualOptions());
    ASSERT_TRUE(found.has_value());
    const Vector6 error = (rendered.truth.T_map_keyframe.inverse() * found->T_map_keyframe).log();
    EXPECT_LT(error.head<3>().norm(), 2e-3) << trial;
    EXPECT_LT(error.tail<3>().norm(), 1e-3) << trial;
    EXPECT_LT((found->xi - rendered.truth.xi).tail<3>().norm(), 4e-3) << trial;
    EXPECT_EQ(rendered.state.size(), Rendered::kKeyframes - 1);
  }
}

TEST(MotionAlignment, LeavesASharpFrameAndOneThatSeesNothing) {
  Random random(6);
  Rendered rendered(longBlur());
  KeyframeState frame = asFrame(rendered, random);
  KeyframeState sharp = frame;
  sharp.xi.setZero();
  EXPECT_FALSE(alignFrame(rendered.state, sharp, ResidualOptions()).has_value());
  frame.T_linear = SE3::exp((Vector6() << 0, 0, 0, 0, M_PI, 0).finished());
  EXPECT_FALSE(alignFrame(rendered.state, frame, ResidualOptions()).has_value());
}

TEST(MotionAlignment, LeavesASharpKeyframeAndOneThatSeesNothing) {
  Rendered sharp(Vector6::Zero());
  EXPECT_FALSE(alignNewest(sharp.state, ResidualOptions()));
  Rendered empty(longBlur());
  empty.state.points.resize(10);
  EXPECT_FALSE(alignNewest(empty.state, ResidualOptions()));
  EXPECT_EQ(empty.newest().xi, empty.truth.xi);
}

TEST(MotionAlignment, TheVelocityFollowsTheMotion) {
  KeyframeState keyframe;
  keyframe.velocity = (Vector6() << 1, 0, 0, 0, 2, 0).finished();
  keyframe.xi = 0.02 * keyframe.velocity;
  const Vector6 motion = (Vector6() << 0, 0.01, 0, 0.03, 0, 0).finished();
  keyframe.setMotion(motion);
  EXPECT_LT((0.02 * keyframe.velocity - motion).norm(), 1e-12);
  EXPECT_EQ(keyframe.image_xi, Vector6(Vector6::Zero())) << "the image is sharp";
}

}  // namespace
}  // namespace mba_vo::test::motion_alignment_test
