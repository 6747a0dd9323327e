#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "mba_vo/geometry/pinhole_camera.h"
#include "mba_vo/geometry/se3.h"
#include "mba_vo/image/image_pyramid.h"

namespace mba_vo::test {

/// Some planes with a smooth solid texture, rendered by casting a ray through every pixel. Knows nothing of warps.
class PlanarScene {
 public:
  struct Plane {
    Eigen::Vector3d normal;
    double distance;  // normal . X = distance
  };
  struct Wave {
    Eigen::Vector3d k;  // [rad/m]
    double amplitude;   // [grey levels]
    double phase;
  };

  /// A slanted back wall, a side wall and a floor.
  static PlanarScene corner(double wave_scale = 1.0) {
    PlanarScene scene;
    scene.planes_ = {{Eigen::Vector3d(0.15, 0.05, 1.0).normalized(), 2.4},
                     {Eigen::Vector3d(-0.9, 0.0, 0.45).normalized(), 1.35},
                     {Eigen::Vector3d(0.0, 1.0, 0.2).normalized(), 0.9}};
    for (int i = 0; i < 14; ++i) {
      const double angle = 2.4 * i;
      const double height = std::sin(1.7 * i + 0.3);
      const double k = wave_scale * (10.0 + 5.5 * i);
      const double flat = std::sqrt(std::max(0.0, 1.0 - height * height));
      scene.waves_.push_back(
          {k * Eigen::Vector3d(flat * std::cos(angle), height, flat * std::sin(angle)), 14.0 - 0.5 * i, 0.9 * i * i});
    }
    return scene;
  }

  /// A wall at this distance that looks the same again after every `period` to the right and downwards [m].
  static PlanarScene wallpaper(double distance, double period) {
    PlanarScene scene;
    scene.planes_ = {{Eigen::Vector3d::UnitZ(), distance}};
    const double k = 2.0 * M_PI / period;
    scene.waves_ = {{k * Eigen::Vector3d::UnitX(), 8.0, 0.3}, {k * Eigen::Vector3d::UnitY(), 8.0, 0.7}};
    return scene;
  }

  double inverseDepth(const PinholeCamera& camera, const SE3& T_world_camera, const Eigen::Vector2d& pixel) const {
    return 1.0 / hit(T_world_camera.translation(), T_world_camera.rotation() * camera.unproject(pixel));
  }

  cv::Mat1f render(const PinholeCamera& camera, const SE3& T_world_camera) const {
    return renderRolling(camera, T_world_camera, Vector6::Zero());
  }

  /// Every row at its time: the camera is at T_world_camera in the middle row and moves with this velocity [m/s,
  /// rad/s].
  cv::Mat1f renderRolling(const PinholeCamera& camera, const SE3& T_world_camera, const Vector6& velocity) const {
    cv::Mat1f image(camera.height, camera.width);
    for (int y = 0; y < camera.height; ++y) {
      const SE3 T = T_world_camera * SE3::exp(camera.rowDelay(y) * velocity);
      for (int x = 0; x < camera.width; ++x) {
        const Eigen::Vector3d ray = T.rotation() * camera.unproject({x, y});
        image(y, x) = static_cast<float>(texture(T.translation() + hit(T.translation(), ray) * ray));
      }
    }
    return image;
  }

  /// Mean of `samples` images at mid-points along the exposure.
  cv::Mat1f renderBlurred(const PinholeCamera& camera, const SE3& T_world_camera, const Vector6& xi,
                          int samples) const {
    cv::Mat1f sum(camera.height, camera.width, 0.0F);
    for (int i = 0; i < samples; ++i) {
      const double u = (i + 0.5) / samples - 0.5;
      cv::scaleAdd(render(camera, T_world_camera * SE3::exp(u * xi)), 1.0 / samples, sum, sum);
    }
    return sum;
  }

 private:
  double hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Plane& plane : planes_) {
      const double s = (plane.distance - plane.normal.dot(origin)) / plane.normal.dot(ray);
      if (s > 0.0 && s < nearest) nearest = s;
    }
    return nearest;
  }

  double texture(const Eigen::Vector3d& X) const {
    double value = 120.0;
    for (const Wave& wave : waves_) value += wave.amplitude * std::sin(wave.k.dot(X) + wave.phase);
    return value;
  }

  std::vector<Plane> planes_;
  std::vector<Wave> waves_;
};

inline PinholeCamera smallCamera() { return {320, 240, 260.0, 262.0, 158.3, 121.1}; }

inline std::shared_ptr<const ImagePyramid> pyramidOf(const cv::Mat1f& image, const PinholeCamera& camera) {
  return std::make_shared<const ImagePyramid>(image, camera, 1);
}

/// Estimate aligned to the truth by its first pose and its scale: relative error of each pose.
inline std::vector<double> alignedPositionErrors(const std::vector<SE3>& truth, const std::vector<SE3>& estimate) {
  std::vector<Eigen::Vector3d> a, b;
  double aa = 0.0, ab = 0.0, extent = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    a.push_back((estimate.front().inverse() * estimate[i]).translation());
    b.push_back((truth.front().inverse() * truth[i]).translation());
    aa += a.back().squaredNorm();
    ab += a.back().dot(b.back());
    extent = std::max(extent, b.back().norm());
  }
  std::vector<double> errors;
  for (std::size_t i = 0; i < a.size(); ++i) errors.push_back((ab / aa * a[i] - b[i]).norm() / extent);
  return errors;
}

}  // namespace mba_vo::test
