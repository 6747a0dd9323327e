#include <array>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

#include "mapping/planar_scene.h"
#include "mba_vo/mapping/window.h"

namespace mba_vo {
namespace {

/// Two blurred keyframes of the analytic scene, at their true poses, and points of true depths in the first one.
struct Pair {
  PinholeCamera camera = test::smallCamera();
  test::PlanarScene scene = test::PlanarScene::corner(0.4);
  std::array<SE3, 2> T_map_keyframe = {SE3(), SE3::exp((Vector6() << 0.05, 0.03, 0.01, 0.02, -0.03, 0.01).finished())};
  std::array<Vector6, 2> xi = {(Vector6() << 0.03, 0.01, 0.0, 0.01, 0.03, 0.02).finished(),
                               (Vector6() << -0.01, 0.02, 0.0, 0.03, -0.02, 0.01).finished()};
  std::shared_ptr<const ImagePyramid> sharp = test::pyramidOf(scene.render(camera, T_map_keyframe[0]), camera);

  /// The first keyframe as a host is sharp or blurred.
  void fill(Window& window, bool is_sharp) const {
    for (std::size_t i = 0; i < 2; ++i) {
      WindowKeyframe keyframe;
      keyframe.id = static_cast<KeyframeId>(i);
      keyframe.original = test::pyramidOf(scene.renderBlurred(camera, T_map_keyframe[i], xi[i], 24), camera);
      keyframe.T_map_keyframe = T_map_keyframe[i];
      keyframe.xi = xi[i];
      keyframe.sharp = i == 0 && is_sharp ? sharp : keyframe.original;
      if (keyframe.sharp == keyframe.original) keyframe.image_xi = xi[i];
      window.addKeyframe(keyframe);
    }
    for (int y = 20; y < camera.height - 20; y += 10) {
      for (int x = 20; x < camera.width - 20; x += 10) {
        window.addPoint(0, {x, y}, scene.inverseDepth(camera, T_map_keyframe[0], {x, y}));
      }
    }
  }
};

TEST(WindowReplacement, ASharpImageThatComesLaterIsAsOneThatWasThereFromTheBeginning) {
  const Pair pair;
  Window replaced(WindowConfig(), true), sharp(WindowConfig(), true);
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

TEST(WindowReplacement, TheWindowGoesOnFromThere) {
  const Pair pair;
  Window window(WindowConfig(), true);
  pair.fill(window, false);
  window.optimize(3);
  window.replaceImage(0, pair.sharp);
  const WindowSummary summary = window.optimize(5);
  EXPECT_LE(summary.final_cost, summary.initial_cost);
  EXPECT_LT((window.T_map_keyframe(1).inverse() * pair.T_map_keyframe[1]).log().norm(), 1e-3);
  EXPECT_THROW(window.replaceImage(7, pair.sharp), std::invalid_argument);
}

}  // namespace
}  // namespace mba_vo
