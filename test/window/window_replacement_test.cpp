#include <array>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

#include "mba_vo/window/window.h"
#include "window/planar_scene.h"

namespace mba_vo::window_replacement_test {
namespace {

/// Two blurred keyframes of the analytic scene, at their true poses, and points of true depths in the first one.
struct Pair {
  PinholeCamera camera = test::smallCamera();
  test::PlanarScene scene = test::PlanarScene::corner(0.4);
  std::array<SE3, 2> T_map_keyframe = {SE3(), SE3::exp((Vector6() << 0.05, 0.03, 0.01, 0.02, -0.03, 0.01).finished())};
  std::array<Vector6, 2> xi = {(Vector6() << 0.03, 0.01, 0.0, 0.01, 0.03, 0.02).finished(),
                               (Vector6() << -0.01, 0.02, 0.0, 0.03, -0.02, 0.01).finished()};
  std::shared_ptr<const ImagePyramid> sharp = test::pyramidOf(scene.render(camera, T_map_keyframe[0]), camera);

  std::vector<ReferencePoint> points() const {
    std::vector<ReferencePoint> points;
    for (int y = 20; y < camera.height - 20; y += 10) {
      for (int x = 20; x < camera.width - 20; x += 10) {
        const double inverse_depth = scene.inverseDepth(camera, T_map_keyframe[0], {x, y});
        points.push_back({Eigen::Vector2f(x, y), static_cast<float>(inverse_depth), 0.0F});
      }
    }
    return points;
  }

  static constexpr double kExposure = 0.02;  // [s]

  /// The first keyframe as a host is sharp or blurred; `knows`: that it is. `told`: the exposures, else both keyframes
  /// count as sharp.
  void fill(Window& window, bool is_sharp, bool knows = true, bool told = true) const {
    for (std::size_t i = 0; i < 2; ++i) {
      WindowKeyframe keyframe;
      keyframe.id = static_cast<KeyframeId>(i);
      keyframe.original = test::pyramidOf(scene.renderBlurred(camera, T_map_keyframe[i], xi[i], 24), camera);
      keyframe.T_map_keyframe = T_map_keyframe[i];
      keyframe.motion.velocity = xi[i] / kExposure;
      if (told) keyframe.xi = xi[i];
      keyframe.sharp = i == 0 && is_sharp ? sharp : keyframe.original;
      if (knows && keyframe.sharp == keyframe.original) keyframe.image_xi = xi[i];
      window.addKeyframe(keyframe);
    }
    for (const ReferencePoint& p : points()) {
      const Eigen::Vector2d pixel = p.pixel.cast<double>();
      window.addPoint(0, pixel, scene.inverseDepth(camera, T_map_keyframe[0], pixel));
    }
  }
};

/// Thresholds follow the residuals, from one time to the next.
WindowSummary settled(Window& window) {
  WindowSummary summary;
  for (int i = 0; i < 5; ++i) summary = window.optimize(0);
  return summary;
}

TEST(WindowReplacement, ASharpImageThatComesLaterIsAsOneThatWasThereFromTheBeginning) {
  const Pair pair;
  Window replaced{WindowConfig()}, sharp{WindowConfig()};
  pair.fill(replaced, false);
  pair.fill(sharp, true);
  const WindowSummary before = replaced.optimize(0);
  sharp.optimize(0);
  replaced.replaceImage(0, pair.sharp);
  const WindowSummary after = replaced.optimize(0);
  const WindowSummary expected = sharp.optimize(0);
  EXPECT_GT(before.residuals, 300);
  EXPECT_NE(before.rms, after.rms);
  EXPECT_EQ(after.residuals, expected.residuals);
  EXPECT_EQ(after.initial_cost, expected.initial_cost);
  EXPECT_EQ(after.rms, expected.rms);
  EXPECT_LT(after.rms, 1.0) << "the sharp image, blurred as the target is, is the target";
}

TEST(WindowReplacement, AnExposureThatIsKnownLaterIsAsOneThatWasKnownFromTheBeginning) {
  const Pair pair;
  Window told{WindowConfig()}, untold{WindowConfig()}, left{WindowConfig()};
  pair.fill(told, false);
  for (Window* window : {&untold, &left}) pair.fill(*window, false, false, false);
  const WindowSummary without = left.optimize(0);
  for (const KeyframeId id : {0, 1}) untold.setExposure(id, Pair::kExposure, true);
  const WindowSummary after = untold.optimize(0);
  const WindowSummary expected = told.optimize(0);
  EXPECT_GT(without.rms, 2.0 * after.rms);
  EXPECT_EQ(after.residuals, expected.residuals);
  EXPECT_NEAR(after.initial_cost, expected.initial_cost, 1e-6 * expected.initial_cost);
  EXPECT_NEAR(after.rms, expected.rms, 1e-6 * expected.rms);
  EXPECT_THROW(untold.setExposure(7, Pair::kExposure, true), std::invalid_argument);
}

// As of a keyframe that did not wait for the frame after it.
TEST(WindowReplacement, AMotionThatIsKnownLaterIsAsOneThatWasKnownFromTheBeginning) {
  const Pair pair;
  Window told{WindowConfig()}, revised{WindowConfig()};
  for (Window* window : {&told, &revised}) pair.fill(*window, false);
  const auto moving = [&](double factor) { return BodyMotion{factor / Pair::kExposure * pair.xi[0]}; };
  revised.setMotion(0, moving(1.5));
  const WindowSummary before = revised.optimize(0);
  revised.setMotion(0, moving(1.0));
  EXPECT_LT((revised.imageMotion(0) - pair.xi[0]).norm(), 1e-12) << "its image is blurred by it";
  const WindowSummary after = settled(revised), expected = settled(told);
  EXPECT_GT(before.rms, 2.0 * expected.rms);
  EXPECT_LT(after.rms, 1.1 * expected.rms);
  EXPECT_THROW(revised.setMotion(7, moving(1.0)), std::invalid_argument);
}

TEST(WindowReplacement, WithARollingShutterTheRowsKnowTheMotionBetter) {
  Pair pair;
  pair.camera.row_time = 2e-5;
  Window window{WindowConfig()};
  pair.fill(window, false);
  const Vector6 before = window.motion(0).velocity;
  window.setMotion(0, {2.0 * before, Vector6::Ones()});
  EXPECT_EQ(window.motion(0).velocity, before);
  EXPECT_EQ(window.motion(0).acceleration, Vector6(Vector6::Zero()));
}

// What was read before has to be read again.
TEST(WindowReplacement, AnExposureMayBeCorrectedAgain) {
  const Pair pair;
  Window told{WindowConfig()}, corrected{WindowConfig()};
  for (Window* window : {&told, &corrected}) pair.fill(*window, false);
  for (const KeyframeId id : {0, 1}) corrected.setExposure(id, 0.8 * Pair::kExposure, true);
  const WindowSummary before = corrected.optimize(0);
  for (const KeyframeId id : {0, 1}) corrected.setExposure(id, Pair::kExposure, true);
  const WindowSummary after = settled(corrected), expected = settled(told);
  EXPECT_GT(before.rms, 2.0 * expected.rms);
  EXPECT_LT(after.rms, 1.5 * expected.rms);
}

TEST(WindowReplacement, TheWindowGoesOnFromThere) {
  const Pair pair;
  Window window{WindowConfig()};
  pair.fill(window, false);
  window.optimize(3);
  window.replaceImage(0, pair.sharp);
  const WindowSummary summary = window.optimize(5);
  EXPECT_LE(summary.final_cost, summary.initial_cost);
  EXPECT_LT((window.T_map_keyframe(1).inverse() * pair.T_map_keyframe[1]).log().norm(), 1e-3);
  EXPECT_THROW(window.replaceImage(7, pair.sharp), std::invalid_argument);
}

TEST(WindowReplacement, TellsWhetherAnImageExplainsTheOthersAsWell) {
  const Pair pair;
  const auto wrong = test::pyramidOf(pair.scene.render(pair.camera, pair.T_map_keyframe[1]), pair.camera);
  for (const bool knows : {true, false}) {
    Window window{WindowConfig()};
    pair.fill(window, false, knows);
    EXPECT_FALSE(window.explainsAsWell(0, wrong, pair.points()));
    if (!knows) {
      EXPECT_TRUE(window.explainsAsWell(0, pair.sharp, pair.points())) << "the blurred one passes for sharp";
    }
    EXPECT_FALSE(window.explainsAsWell(0, pair.sharp, {})) << "nothing to compare";
  }
}

TEST(WindowReplacement, TryingAnImageChangesNothing) {
  const Pair pair;
  Window tried{WindowConfig()}, other{WindowConfig()};
  for (Window* window : {&tried, &other}) {
    pair.fill(*window, false);
    window->optimize(2);
  }
  tried.explainsAsWell(0, pair.sharp, pair.points());
  EXPECT_EQ(tried.optimize(3).final_cost, other.optimize(3).final_cost);
  EXPECT_EQ(tried.T_map_keyframe(1).log(), other.T_map_keyframe(1).log());
}

}  // namespace
}  // namespace mba_vo::window_replacement_test
