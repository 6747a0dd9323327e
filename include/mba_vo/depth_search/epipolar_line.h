#pragma once

#include <Eigen/Core>

#include "mba_vo/blur/row_motion.h"
#include "mba_vo/geometry/pinhole_camera.h"
#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// Maps a host pixel of known inverse depth into another image: P = R K_host^-1 (u, v, 1) + inverse_depth t, times K.
struct HostToFrame {
  HostToFrame(const PinholeCamera& host, const PinholeCamera& frame, const RigidMotion& T_frame_host);
  HostToFrame(const PinholeCamera& host, const PinholeCamera& frame, const SE3& T_frame_host)
      : HostToFrame(host, frame, RigidMotion(T_frame_host)) {}

  Eigen::Matrix3d H;  // K_frame R K_host^-1
  Eigen::Vector3d h;  // K_frame t
};

/// Image of the ray of one host pixel in another image: a straight line, along which the distance s [px] from the image
/// of the point at infinity grows with the inverse depth: s = inverse_depth k / (1 + inverse_depth q).
class EpipolarLine {
 public:
  EpipolarLine(const HostToFrame& transform, const Eigen::Vector2d& host_pixel);

  /// False if the point at infinity is behind the frame's camera or depth has no influence on the image.
  bool isValid() const { return valid_; }

  const Eigen::Vector2d& direction() const { return direction_; }  // unit vector towards smaller depth
  Eigen::Vector2d pixelAt(double s) const { return origin_ + s * direction_; }

  /// Infinity if the point is behind the frame's camera.
  double distanceOf(double inverse_depth) const;
  /// Infinity at and past the epipole, where no depth leads. Negative for s < 0.
  double inverseDepthAt(double s) const;

  /// Image of one host pixel step to the right and down (columns), for a surface parallel to the host's image plane.
  Eigen::Matrix2d warpAt(double inverse_depth) const;

 private:
  bool valid_ = false;
  Eigen::Matrix3d H_;
  double infinity_z_ = 0.0;  // depth ratio of the point at infinity
  double translation_z_ = 0.0;
  Eigen::Vector2d origin_;
  Eigen::Vector2d direction_;
  double k_ = 0.0;  // [px m]
  double q_ = 0.0;  // [m]
};

}  // namespace mba_vo
