#pragma once

#include <Eigen/Core>

namespace mba_vo {

/// Ideal pinhole camera of a rectified image. Pixel centres are at integer coordinates, optical frame (z forward, x
/// right, y down).
struct PinholeCamera {
  int width = 0;          // [px]
  int height = 0;         // [px]
  double fx = 1.0;        // [px]
  double fy = 1.0;        // [px]
  double cx = 0.0;        // [px]
  double cy = 0.0;        // [px]
  double row_time = 0.0;  // rolling shutter: from one row to the next [s], 0 = global shutter

  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }

  /// Ray through `pixel` with z = 1.
  Eigen::Vector3d unproject(const Eigen::Vector2d& pixel) const {
    return {(pixel.x() - cx) / fx, (pixel.y() - cy) / fy, 1.0};
  }

  /// When a row is exposed, counted from the middle row [s].
  double rowDelay(double row) const { return (row - 0.5 * (height - 1)) * row_time; }

  /// d project(point) / d point.
  Eigen::Matrix<double, 2, 3> projectionJacobian(const Eigen::Vector3d& point) const;

  /// True where bilinear sampling is possible at least `border` pixels from the edge.
  bool contains(const Eigen::Vector2d& pixel, double border = 0.0) const {
    return pixel.x() >= border && pixel.y() >= border && pixel.x() <= width - 1 - border &&
           pixel.y() <= height - 1 - border;
  }

  /// The same camera for the image halved once: c -> (c + 1/2) / 2 - 1/2, because pixel centres are at integers.
  PinholeCamera halved() const;
};

}  // namespace mba_vo
