#pragma once

#include <memory>
#include <vector>

#include "mba_vo/pose_graph/loop_keyframe.h"
#include "support/rendered_room.h"

namespace mba_vo::test {

inline constexpr double kKeyframeExposure = 0.02;  // [s]

inline SE3 moved(const SE3& T, double right, double down, double forward, double yaw_degrees) {
  Vector6 motion;
  motion << right, down, forward, 0.0, yaw_degrees * M_PI / 180.0, 0.0;
  return T * SE3::exp(motion);
}

/// How a keyframe comes about: where the camera was and how it moved, what the odometry makes of it.
struct KeyframeSetup {
  KeyframeId id = 0;
  double seconds = 0.0;                // when
  SE3 T_world_camera;                  // in truth
  Vector6 velocity = Vector6::Zero();  // [m/s, rad/s]
  std::optional<SE3> T_map_camera;     // by the odometry, if it is wrong; in its unit
  double unit = 1.0;                   // of the odometry [m]
  MapId map = 1;
};

/// As it would leave the window: true depths with 1 % of noise.
inline ArchivedKeyframeConstPtr makeKeyframe(const KeyframeSetup& setup, const Simulator& room = roomSimulator()) {
  const SimulatedFrame rendered =
      room.renderExposure(constantVelocity(setup.T_world_camera, setup.velocity), 0.0, kKeyframeExposure, setup.id);
  const bool blurred = !setup.velocity.isZero();
  auto reference = makeReference(rendered, toFloat(blurred ? rendered.blurred : rendered.sharp), 500);
  cv::RNG random(setup.id + 1);
  for (ReferencePoint& point : reference->points) {
    point.inverse_depth *= static_cast<float>(setup.unit * (1.0 + 0.01 * random.gaussian(1.0)));
    point.variance = 1e-4F * point.inverse_depth * point.inverse_depth;
  }
  const auto frame = std::make_shared<Frame>();
  frame->sequence = setup.id;
  frame->exposure = reference->exposure = blurred ? kKeyframeExposure : 0.0;
  frame->mid_exposure_ns = reference->mid_exposure_ns = std::llround(1e9 * setup.seconds);
  frame->pyramid = *reference->pyramid;
  reference->id = {setup.map, setup.id, 0};
  reference->T_map_reference = setup.T_map_camera.value_or(
      SE3(setup.T_world_camera.rotation(), setup.T_world_camera.translation() / setup.unit));
  reference->T_map_keyframe = {{setup.id, reference->T_map_reference}};
  reference->motion.velocity = setup.velocity;
  reference->motion.velocity.head<3>() /= setup.unit;
  reference->image_xi = kKeyframeExposure * reference->motion.velocity;
  return archiveForLoops(*reference, *frame);
}

}  // namespace mba_vo::test
