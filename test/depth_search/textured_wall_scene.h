#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "mba_vo/geometry/exposure_trajectory.h"
#include "mba_vo/image/image_pyramid.h"

namespace mba_vo::test {

/// Smooth random texture: plane waves of many directions, wavelengths 0.06 to 0.35 m [grey levels, mean 128].
class WaveTexture {
 public:
  explicit WaveTexture(unsigned seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (Wave& wave : waves_) {
      const double angle = 2.0 * M_PI * uniform(rng);
      const double k = 2.0 * M_PI / (0.06 * std::pow(0.35 / 0.06, uniform(rng)));
      wave = {k * std::cos(angle), k * std::sin(angle), 2.0 * M_PI * uniform(rng)};
    }
  }
  double operator()(double x, double y) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) sum += std::sin(wave.kx * x + wave.ky * y + wave.phase);
    return 128.0 + 18.0 * sum;
  }

 private:
  struct Wave {
    double kx, ky, phase;
  };
  std::array<Wave, 14> waves_;
};

/// Plane n . X = 1 [1/m] with a texture over X and Y, seen where `x_min` <= X <= `x_max` [m].
struct TexturedPlane {
  Eigen::Vector3d n;
  std::function<double(double, double)> texture;
  double x_min = -std::numeric_limits<double>::infinity();
  double x_max = std::numeric_limits<double>::infinity();
};

/// Textured planes seen by a pinhole camera, by casting one ray per pixel and moment.
class PlaneScene {
 public:
  PlaneScene(const PinholeCamera& camera, std::vector<TexturedPlane> planes)
      : camera_(camera), planes_(std::move(planes)) {}

  struct Hit {
    Eigen::Vector3d point;  // in the world
    double depth = std::numeric_limits<double>::infinity();
    const TexturedPlane* plane = nullptr;
  };

  Hit cast(const SE3& T_world_camera, const Eigen::Vector2d& pixel) const {
    const Eigen::Vector3d origin = T_world_camera.translation();
    const Eigen::Vector3d ray = T_world_camera.rotation() * camera_.unproject(pixel);
    Hit nearest;
    for (const TexturedPlane& plane : planes_) {
      const double depth = (1.0 - plane.n.dot(origin)) / plane.n.dot(ray);
      const Eigen::Vector3d point = origin + depth * ray;
      const bool seen = depth > 0.0 && point.x() >= plane.x_min && point.x() <= plane.x_max;
      if (seen && depth < nearest.depth) nearest = {point, depth, &plane};
    }
    return nearest;
  }

  double inverseDepth(const SE3& T_world_camera, const Eigen::Vector2d& pixel) const {
    return 1.0 / cast(T_world_camera, pixel).depth;
  }

  /// Mean over `moments` of the exposure, with noise [grey levels]; pixels that see nothing are black.
  ImagePyramid render(const ExposureTrajectory& T_world, int moments, double noise, unsigned seed) const {
    cv::Mat1f image(camera_.height, camera_.width, 0.0F);
    for (int i = 0; i < moments; ++i) {
      const SE3 pose = T_world.at(((i + 0.5) / moments - 0.5) * T_world.exposure);
      for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < image.cols; ++x) {
          const Hit hit = cast(pose, Eigen::Vector2d(x, y));
          if (hit.plane == nullptr) continue;
          image(y, x) += static_cast<float>(hit.plane->texture(hit.point.x(), hit.point.y()) / moments);
        }
      }
    }
    std::mt19937 rng(seed);
    std::normal_distribution<double> normal(0.0, noise);
    for (float& value : image) value += static_cast<float>(normal(rng));
    return {image, camera_, 3};
  }

  const PinholeCamera& camera() const { return camera_; }

 private:
  PinholeCamera camera_;
  std::vector<TexturedPlane> planes_;
};

}  // namespace mba_vo::test
