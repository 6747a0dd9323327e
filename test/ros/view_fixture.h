#pragma once

#include <memory>
#include <vector>

#include "mba_vo/ros/motion_messages.h"

namespace mba_vo::test {

inline PinholeCamera viewCamera(double row_time = 0.0) { return {320, 240, 300.0, 310.0, 161.0, 118.0, row_time}; }

/// A grey image of one brightness.
inline ImagePyramid plainPyramid(const PinholeCamera& camera) {
  return ImagePyramid(cv::Mat1f(camera.height, camera.width, 100.0F), camera, 1);
}

inline SE3 viewPose(double x, double y, double z, double turn) {
  return SE3(Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d(0.2, 1.0, -0.3).normalized())), {x, y, z});
}

/// Keyframe 3 of map 2 with points at these pixels and depths [m], in a window with keyframe 1.
inline std::shared_ptr<Reference> viewReference(const std::vector<Eigen::Vector3f>& points) {
  auto reference = std::make_shared<Reference>();
  reference->id = {2, 3, 0};
  reference->pyramid = std::make_shared<const ImagePyramid>(plainPyramid(viewCamera()));
  reference->T_map_reference = viewPose(1.0, 0.5, -0.2, 0.4);
  reference->T_map_keyframe = {{1, SE3()}, {3, reference->T_map_reference}};
  for (const Eigen::Vector3f& p : points) reference->points.push_back({p.head<2>(), 1.0F / p.z(), 1e-4F});
  return reference;
}

/// A frame that turned and moved by some pixels within 30 ms, tracked with viewReference.
inline std::shared_ptr<TrackedFrame> viewFrame(const PinholeCamera& camera = viewCamera()) {
  auto frame = std::make_shared<Frame>();
  frame->mid_exposure_ns = 7'000'000'000;
  frame->stamp_ns = 7'000'000'000;
  frame->exposure = 0.03;
  frame->pyramid = plainPyramid(camera);
  auto tracked = std::make_shared<TrackedFrame>();
  tracked->frame = frame;
  tracked->status = TrackingStatus::kTracking;
  tracked->reference = {2, 3, 0};
  tracked->trajectory.T_reference_mid = viewPose(0.05, -0.02, 0.1, 0.03);
  tracked->trajectory.velocity << 0.5, -0.3, 0.2, 0.4, -2.0, 1.0;
  tracked->trajectory.exposure = 0.03;
  return tracked;
}

}  // namespace mba_vo::test
