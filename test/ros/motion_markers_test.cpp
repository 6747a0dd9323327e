#include "mba_vo/ros/motion_markers.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/ros/conversions.h"
#include "ros/view_fixture.h"

namespace mba_vo::motion_markers_test {
namespace {

using test::viewCamera;
using test::viewFrame;
using test::viewPose;
using test::viewReference;
using visualization_msgs::Marker;

MeasuredMotion viewMotion() {
  MeasuredMotion motion;
  motion.tracked = viewFrame();
  motion.T_map_odom = viewPose(0.1, 0.2, 0.3, 0.1);
  motion.T_odom_camera = viewPose(1.0, -0.4, 0.2, 0.5);
  motion.motion = motion.tracked->trajectory.motion();
  motion.T_base_camera = viewPose(0.2, 0.0, 0.1, -0.7);
  return motion;
}

const Marker& find(const visualization_msgs::MarkerArray& markers, const std::string& ns, int id) {
  const auto found = std::find_if(markers.markers.begin(), markers.markers.end(),
                                  [&](const Marker& marker) { return marker.ns == ns && marker.id == id; });
  if (found == markers.markers.end()) throw std::out_of_range(ns);
  return *found;
}

Eigen::Vector3d position(const geometry_msgs::Point& point) { return {point.x, point.y, point.z}; }

/// Smallest distance of any of the marker's points to this one.
double distanceTo(const Marker& marker, const Eigen::Vector3d& place) {
  double smallest = 1e9;
  for (const auto& point : marker.points) smallest = std::min(smallest, (position(point) - place).norm());
  return smallest;
}

TEST(MotionMarkers, FrustaStandWhereTheCameraWasAtStartAndEnd) {
  const MeasuredMotion motion = viewMotion();
  const auto reference = viewReference({{80.0F, 60.0F, 2.0F}, {200.0F, 90.0F, 4.0F}, {160.0F, 140.0F, 9.0F}});
  const auto markers = makeMarkers(motion, *reference, "the_map");
  const SE3 T_map_mid = motion.T_base_camera * motion.T_map_odom * motion.T_odom_camera;
  for (const int id : {0, 1}) {
    const Marker& frustum = find(markers, "exposure", id);
    EXPECT_EQ(frustum.header.frame_id, "the_map");
    EXPECT_EQ(toNanoseconds(frustum.header.stamp), 7'000'000'000);
    EXPECT_EQ(frustum.points.size(), 16U) << "eight edges";
    const SE3 T_map_camera = T_map_mid * SE3::exp((id == 0 ? -0.015 : 0.015) * motion.tracked->trajectory.velocity);
    EXPECT_LT(distanceTo(frustum, T_map_camera.translation()), 1e-9);
    // The corners, seen by the camera that stands there, are those of the image.
    int corners = 0;
    for (const auto& point : frustum.points) {
      const Eigen::Vector3d seen = T_map_camera.inverse() * position(point);
      if (seen.norm() < 1e-9) continue;
      const Eigen::Vector2d pixel = viewCamera().project(seen);
      EXPECT_NEAR(std::abs(pixel.x() - 159.5), 160.0, 1e-6);
      EXPECT_NEAR(std::abs(pixel.y() - 119.5), 120.0, 1e-6);
      ++corners;
    }
    EXPECT_EQ(corners, 12);
  }
}

TEST(MotionMarkers, TheSweptPathJoinsTheTwoFrusta) {
  const auto reference = viewReference({{80.0F, 60.0F, 2.0F}});
  const auto markers = makeMarkers(viewMotion(), *reference, "map");
  const Marker& surface = find(markers, "exposure", 2);
  const Marker& ways = find(markers, "exposure", 3);
  ASSERT_EQ(surface.type, Marker::TRIANGLE_LIST);
  EXPECT_EQ(surface.points.size() % 3, 0U);
  EXPECT_EQ(surface.colors.size(), surface.points.size());
  EXPECT_EQ(ways.colors.size(), ways.points.size());
  for (const int id : {0, 1}) {
    for (const auto& point : find(markers, "exposure", id).points) {
      EXPECT_LT(distanceTo(ways, position(point)), 1e-9) << "the camera or a corner, at an end of its way";
    }
  }
}

TEST(MotionMarkers, SizesFollowTheScaleOfTheMap) {
  MeasuredMotion motion = viewMotion();
  const auto lengthOf = [&](float depth) {
    const auto markers = makeMarkers(motion, *viewReference({{80.0F, 60.0F, depth}}), "map");
    const Marker& frustum = find(markers, "exposure", 0);
    return std::make_pair((position(frustum.points[1]) - position(frustum.points[0])).norm(), frustum.scale.x);
  };
  EXPECT_NEAR(lengthOf(20.0F).first, 10.0 * lengthOf(2.0F).first, 1e-5);
  EXPECT_NEAR(lengthOf(20.0F).second, 10.0 * lengthOf(2.0F).second, 1e-6);
  EXPECT_GT(lengthOf(2.0F).second, 0.0);
}

TEST(MotionMarkers, KeyframesOfTheWindowAreThere) {
  const MeasuredMotion motion = viewMotion();
  const auto reference = viewReference({{80.0F, 60.0F, 2.0F}});
  const auto markers = makeMarkers(motion, *reference, "map");
  const Marker& keyframes = find(markers, "keyframes", 0);
  EXPECT_EQ(keyframes.points.size(), 2U * 16U);
  for (const auto& [id, T_map_keyframe] : reference->T_map_keyframe) {
    EXPECT_LT(distanceTo(keyframes, (motion.T_base_camera * T_map_keyframe).translation()), 1e-9) << id;
  }
  EXPECT_EQ(deleteMarkers().markers.at(0).action, Marker::DELETEALL);
}

}  // namespace
}  // namespace mba_vo::motion_markers_test
