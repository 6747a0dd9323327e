#pragma once

#include <memory>

#include "mba_vo/simulation/renderer.h"
#include "mba_vo/simulation/simulator.h"

namespace mba_vo {

/// Light of 255 on everything, texture 0 black, 1 white, 2 noise of many scales.
inline Scene emptyScene() {
  Scene scene;
  for (const float tone : {0.0F, 0.8F}) scene.textures.emplace_back([tone] { return Texture(cv::Mat1f(2, 2, tone)); });
  cv::Mat1f noise(256, 256, 0.5F);
  cv::RNG random(7);
  for (int cells = 8; cells <= 128; cells *= 2) {
    for (int y = 0; y < 256; y += 256 / cells) {
      for (int x = 0; x < 256; x += 256 / cells) {
        const float value = random.uniform(-0.12F, 0.12F);
        noise(cv::Rect(x, y, 256 / cells, 256 / cells)).forEach([&](float& v, const int*) { v += value; });
      }
    }
  }
  scene.textures.emplace_back([noise] { return Texture(noise); });
  return scene;
}

/// A rectangle at depth z that faces a camera at the origin looking along world z (x right, y down).
inline Surface facing(double left, double top, double right, double bottom, double z, int texture) {
  Surface s;
  s.origin = {left, bottom, z};
  s.axis_u = Eigen::Vector3d::UnitX();
  s.axis_v = -Eigen::Vector3d::UnitY();
  s.length_u = right - left;
  s.length_v = bottom - top;
  s.texture = texture;
  s.scale_u = s.scale_v = 200.0;
  return s;
}

/// The room of seed 1, painted once for all tests.
inline std::shared_ptr<const Scene> sharedRoom() {
  static const std::shared_ptr<const Scene> room = std::make_shared<const Scene>(makeRoom(1));
  return room;
}

inline SimulationConfig smallConfig() {
  SimulationConfig config;
  config.resize(188, 120);
  return config;
}

inline PoseFunction slide(const Eigen::Vector3d& velocity) {
  return [velocity](double t) { return SE3(Eigen::Quaterniond::Identity(), t * velocity); };
}

}  // namespace mba_vo
