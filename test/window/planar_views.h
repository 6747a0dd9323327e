#pragma once

#include <cmath>
#include <vector>

#include "mba_vo/window/window.h"
#include "support/random.h"
#include "window/planar_scene.h"

namespace mba_vo::test {

inline constexpr KeyframeId kFrames = 5;

/// Keyframes of the analytic scene: sharp, and blurred by integration over their exposure.
struct Views {
  PinholeCamera camera = smallCamera();
  PlanarScene scene = PlanarScene::corner(0.4);
  std::vector<SE3> truth;
  std::vector<Vector6> xi;
  std::vector<cv::Mat1f> sharp;
  std::vector<cv::Mat1f> blurred;

  Views() {
    for (KeyframeId i = 0; i < kFrames; ++i) {
      const double t = static_cast<double>(i);
      Vector6 v, motion;
      v << 0.06 * t, 0.035 * std::sin(1.1 * t), 0.02 * std::sin(0.7 * t + 1.0), 0.02 * std::sin(0.9 * t), -0.012 * t,
          0.015 * std::cos(t);
      motion << 0.03 * std::cos(2.0 * t), 0.02 * std::sin(1.0 + t), 0.0, 0.02 * std::sin(2.0 * t),
          0.03 * std::cos(3.0 * t), 0.02;
      truth.push_back(SE3::exp(v));
      xi.push_back(motion);
      sharp.push_back(scene.render(camera, truth.back()));
      blurred.push_back(scene.renderBlurred(camera, truth.back(), motion, 24));
    }
  }
};

inline const Views& views() {
  static const Views kViews;
  return kViews;
}

struct Disturbance {
  SE3 T_world_map;     // the window's map is the world moved by this
  double scale = 1.0;  // and scaled
  double pose_noise = 1.0;
  double depth_noise = 0.05;
  int step = 12;  // between points [px]
};

/// Keyframes with disturbed poses, and points on a grid with disturbed inverse depths, in all of them.
inline void fill(Window& window, const std::vector<WindowKeyframe>& images, const Disturbance& setup) {
  const Views& v = views();
  Random random(3);
  for (KeyframeId i = 0; i < kFrames; ++i) {
    WindowKeyframe keyframe = images[i];
    keyframe.id = i;
    SE3 guess = v.truth[i];
    if (i > 0) guess = guess * SE3::exp(setup.pose_noise * random.tangent(0.01, 0.004));
    guess = setup.T_world_map.inverse() * guess;
    keyframe.T_map_keyframe = SE3(guess.rotation(), setup.scale * guess.translation());
    keyframe.xi.head<3>() *= setup.scale;
    window.addKeyframe(keyframe);
  }
  for (KeyframeId i = 0; i < kFrames; ++i) {
    for (int y = 12; y < v.camera.height - 12; y += setup.step) {
      for (int x = 12; x < v.camera.width - 12; x += setup.step) {
        const double d = v.scene.inverseDepth(v.camera, v.truth[i], {x, y}) / setup.scale;
        window.addPoint(i, {x, y}, d * std::exp(random.normal(setup.depth_noise)));
      }
    }
  }
}

inline std::vector<WindowKeyframe> keyframesOf(const std::vector<cv::Mat1f>& hosts,
                                               const std::vector<cv::Mat1f>& targets, bool moving) {
  std::vector<WindowKeyframe> keyframes;
  for (KeyframeId i = 0; i < kFrames; ++i) {
    WindowKeyframe k;
    k.sharp = pyramidOf(hosts[i], views().camera);
    k.original = pyramidOf(targets[i], views().camera);
    if (moving) k.xi = views().xi[i];
    keyframes.push_back(k);
  }
  return keyframes;
}

}  // namespace mba_vo::test
