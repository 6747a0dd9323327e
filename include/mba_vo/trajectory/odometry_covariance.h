#pragma once

#include <cstdint>
#include <optional>

#include "mba_vo/trajectory/odometry_velocity.h"

namespace mba_vo {

/// Covariances of what is published for one image, in the camera's axes. Lengths are in units of the present map; what
/// the odometry had gathered before it counts in units of the maps of then.
struct MotionCovariance {
  Matrix6 odom = Matrix6::Zero();      // of T_odom_camera's right increment (translation [m], rotation [rad])
  Matrix6 map = Matrix6::Zero();       // of T_map_camera's
  Matrix6 velocity = Matrix6::Zero();  // of the velocity at mid-exposure [m/s, rad/s]
};

/// Follows what is published, image by image, and says how well it is known. In a map, where its first pose is exact by
/// definition:
///   map   an alignment ties the map to that pose. The keyframe in use is known relative to the one before as well
///         as the last frame was; of that a share remains once the map has been optimised with the next one, and
///         adds up along the keyframes. What the map is corrected by tells how well it was known. Its scale is that
///         of its first depths, which a short way has told, and drifts a little with each keyframe. Then comes the
///         alignment of the frame itself, which errs by more than its noise where it is hardly determined.
///   odom  moreover, odometry does not follow when the map is corrected, nor when a lost camera is found again:
///         what map -> odom has moved by since the map began is missing in it.
/// Between two maps nothing measures the position, and nothing the rotation until there is a result again: the camera
/// is taken to have gone on as fast as it moved in the rms until then.
class OdometryCovariance {
 public:
  /// The result of the next image, whatever it is, and the velocity of the last one with a measured pose. Without pose
  /// and orientation all is zero.
  MotionCovariance update(const TrackedFrame& tracked, const VelocityEstimate& velocity, const SE3& T_odom_camera,
                          const SE3& T_map_odom);
  /// Odometry begins anew.
  void reset() { *this = OdometryCovariance(); }

 private:
  /// What was published last with a pose.
  struct Pose {
    ReferenceId reference;
    std::int64_t mid_exposure_ns = 0;
    SE3 T_odom_camera;
    SE3 T_map_odom;
    Matrix6 alignment = Matrix6::Zero();  // of its right increment
    MotionCovariance covariance;
  };
  struct MeanSquares {
    double linear = 0.0;   // [m^2/s^2]
    double angular = 0.0;  // [rad^2/s^2]
  };

  /// Moments of where errors of the scale came in, by their variances, for the positions that they displace.
  struct ScaleChanges {
    double variance = 0.0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  };

  MotionCovariance reckoned(const TrackedFrame& tracked, const VelocityEstimate& velocity, const SE3& T_camera_odom,
                            double seconds);
  double placeVariance(const VelocityEstimate& velocity, double seconds) const;
  void closeMap(const SE3& T_odom_camera, double seconds);
  void beginMap(const TrackedFrame& tracked, const SE3& T_odom_camera, const SE3& T_map_odom);
  void goOnInMap(const TrackedFrame& tracked, const SE3& T_odom_camera, const SE3& T_map_odom);
  void useKeyframe(const SE3& T_odom_camera, const Matrix6& alignment);
  void changeScale(const Eigen::Vector3d& place, double sigma);
  Matrix6 scaleErrors(const SE3& T_odom_camera) const;
  void observeSpeed(const Vector6& velocity);

  // In odom's axes at its origin: of a left increment of T_odom_camera, which stays the same while the camera moves.
  Matrix6 before_ = Matrix6::Zero();    // from before this map
  Matrix6 map_ = Matrix6::Zero();       // of the keyframes before the one in use, and of corrections of the map
  Matrix6 keyframe_ = Matrix6::Zero();  // of the keyframe in use, relative to the one before
  ScaleChanges scales_;                 // in this map
  SE3 T_map_odom_first_;                // when this map began
  std::optional<Pose> last_;
  bool has_map_ = false;
  bool lost_ = false;        // since then
  std::int64_t frames_ = 0;  // whose speed is in `speed_`
  MeanSquares speed_;        // so far
};

}  // namespace mba_vo
