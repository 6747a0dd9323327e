#include "mba_vo/mapping/window.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include <gtest/gtest.h>

#include "mapping/planar_scene.h"
#include "support/random.h"

namespace mba_vo {
namespace {

using test::PlanarScene;

struct Sequence {
  PinholeCamera camera = test::smallCamera();
  std::vector<SE3> truth;
  std::vector<Vector6> xi;
  std::vector<std::shared_ptr<const ImagePyramid>> sharp;
  std::vector<std::shared_ptr<const ImagePyramid>> original;
};

SE3 poseAt(int i) {
  Vector6 v;
  v << 0.06 * i, 0.035 * std::sin(1.1 * i), 0.02 * std::sin(0.7 * i + 1.0), 0.02 * std::sin(0.9 * i), -0.012 * i,
      0.015 * std::cos(i);
  return SE3::exp(v);
}

Sequence makeSequence(int frames, double blur) {
  Sequence s;
  const PlanarScene scene = PlanarScene::corner();
  for (int i = 0; i < frames; ++i) {
    s.truth.push_back(poseAt(i));
    Vector6 xi;
    xi << 0.03 * std::cos(2.0 * i), 0.02 * std::sin(1.0 + i), 0.0, 0.02 * std::sin(2.0 * i), 0.03 * std::cos(3.0 * i),
        0.02;
    s.xi.push_back(blur * xi);
    s.sharp.push_back(test::pyramidOf(scene.render(s.camera, s.truth.back()), s.camera));
    s.original.push_back(blur > 0.0
                             ? test::pyramidOf(scene.renderBlurred(s.camera, s.truth.back(), s.xi.back(), 24), s.camera)
                             : s.sharp.back());
  }
  return s;
}

void addGrid(Window& window, const Sequence& s, KeyframeId host, int step, double depth_noise, test::Random& random) {
  const PlanarScene scene = PlanarScene::corner();
  for (int y = 12; y < s.camera.height - 12; y += step) {
    for (int x = 12; x < s.camera.width - 12; x += step) {
      const double d = scene.inverseDepth(s.camera, s.truth[host], {x, y});
      window.addPoint(host, {x, y}, d * std::exp(random.normal(depth_noise)));
    }
  }
}

TEST(Window, Recovers) {
  for (const double blur : {0.0, 1.0}) {
    for (const bool reblur : {false, true}) {
      const Sequence s = makeSequence(5, blur);
      test::Random random(3);
      WindowConfig config;
      config.reblur_targets = reblur;
      Window window(config, true);
      std::vector<SE3> initial;
      for (KeyframeId i = 0; i < 5; ++i) {
        const SE3 guess = i == 0 ? s.truth[0] : s.truth[i] * SE3::exp(random.tangent(0.01, 0.004));
        initial.push_back(guess);
        window.addKeyframe({i, reblur ? s.sharp[i] : s.original[i], s.original[i], guess, s.xi[i], {}});
      }
      for (KeyframeId i = 0; i < 5; ++i) addGrid(window, s, i, 12, 0.05, random);
      for (int round = 0; round < 4; ++round) {
        const auto t0 = std::chrono::steady_clock::now();
        const WindowSummary summary = window.optimize(10);
        const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - t0).count();
        std::vector<SE3> estimate;
        for (KeyframeId i = 0; i < 5; ++i) estimate.push_back(window.T_map_keyframe(i));
        const auto e = test::alignedPositionErrors(s.truth, estimate);
        const auto e0 = test::alignedPositionErrors(s.truth, initial);
        std::printf("blur %g reblur %d: cost %g -> %g it %d res %d rms %g  err %g (init %g) %d points %.1f ms\n", blur,
                    reblur, summary.initial_cost, summary.final_cost, summary.iterations, summary.residuals,
                    summary.rms, *std::max_element(e.begin(), e.end()), *std::max_element(e0.begin(), e0.end()),
                    window.pointCount(), ms);
      }
    }
  }
}

}  // namespace
}  // namespace mba_vo
