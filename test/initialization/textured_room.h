#pragma once

#include <cmath>

#include <opencv2/core.hpp>

#include "mba_vo/geometry/pinhole_camera.h"
#include "mba_vo/geometry/se3.h"

namespace mba_vo::initializer_test {

inline const PinholeCamera kCamera{376, 240, 215.0, 215.0, 187.5, 119.5};

inline double hash(int x, int y) {
  auto h = static_cast<unsigned>(x) * 374761393U + static_cast<unsigned>(y) * 668265263U;
  h = (h ^ (h >> 13U)) * 1274126177U;
  return static_cast<double>((h ^ (h >> 16U)) & 0xffffU) / 65535.0;
}

/// Smooth noise of unit wavelength in [0, 1].
inline double noise(double x, double y) {
  const double fx = std::floor(x), fy = std::floor(y);
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const auto ease = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double u = ease(x - fx), v = ease(y - fy);
  return (1 - v) * ((1 - u) * hash(ix, iy) + u * hash(ix + 1, iy)) +
         v * ((1 - u) * hash(ix, iy + 1) + u * hash(ix + 1, iy + 1));
}

inline double texture(double x, double y) {
  return 40.0 + 110.0 * noise(7.0 * x, 7.0 * y) + 80.0 * noise(17.0 * x + 5.0, 17.0 * y);
}

/// A wall at z = 3 m; in the room also a floor at y = 0.7 m and a board that stands in front of the wall.
struct Scene {
  bool planar = false;
  bool textured = true;

  struct Hit {
    double depth;  // along the ray, in units of the ray
    double grey;   // [grey levels]
  };
  Hit hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) const {
    Hit best{(3.0 - origin.z()) / ray.z(), 0.0};
    Eigen::Vector3d p = origin + best.depth * ray;
    best.grey = texture(p.x(), p.y());
    if (!planar) {
      const double floor = ray.y() > 1e-6 ? (0.7 - origin.y()) / ray.y() : 1e9;
      p = origin + floor * ray;
      if (floor > 0.0 && floor < best.depth) best = {floor, texture(p.x() + 30.0, p.z())};
      const double board = (1.5 - origin.z()) / ray.z();
      p = origin + board * ray;
      if (board < best.depth && std::abs(p.x() + 0.4) < 0.35) best = {board, texture(p.x() + 60.0, p.y())};
    }
    if (!textured) best.grey = 100.0;
    return best;
  }
};

/// `T_world_row`: pose of the camera when a row is exposed.
template <typename PoseOfRow>
cv::Mat1f renderRows(const Scene& scene, const PoseOfRow& T_world_row) {
  cv::Mat1f image(kCamera.height, kCamera.width);
  for (int y = 0; y < image.rows; ++y) {
    const SE3 T_world_camera = T_world_row(y);
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector3d ray = T_world_camera.rotation() * kCamera.unproject({x, y});
      image(y, x) = static_cast<float>(scene.hit(T_world_camera.translation(), ray).grey);
    }
  }
  return image;
}

inline cv::Mat1f render(const Scene& scene, const SE3& T_world_camera) {
  return renderRows(scene, [&](int) { return T_world_camera; });
}

}  // namespace mba_vo::initializer_test
