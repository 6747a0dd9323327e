#include "mba_vo/ros/motion_markers.h"

#include <array>
#include <vector>

#include "mba_vo/ros/conversions.h"
#include "mba_vo/tracking/frame_measures.h"

namespace mba_vo {
namespace {

// Shares of the median depth.
constexpr double kFrustumLength = 0.35;
constexpr double kKeyframeLength = 0.08;
constexpr double kLineWidth = 0.004;

constexpr int kSweptParts = 12;  // parts of the swept path

using Marker = visualization_msgs::Marker;
using Corners = std::array<Eigen::Vector3d, 4>;

std_msgs::ColorRGBA color(float red, float green, float blue, float alpha) {
  std_msgs::ColorRGBA rgba;
  rgba.r = red, rgba.g = green, rgba.b = blue, rgba.a = alpha;
  return rgba;
}

std_msgs::ColorRGBA startColor(float alpha) { return color(0.2F, 0.9F, 0.4F, alpha); }
std_msgs::ColorRGBA endColor(float alpha) { return color(1.0F, 0.55F, 0.1F, alpha); }

geometry_msgs::Point toPoint(const Eigen::Vector3d& position) {
  geometry_msgs::Point point;
  point.x = position.x(), point.y = position.y(), point.z = position.z();
  return point;
}

/// Of the image, on the plane z = `length`, in the camera; in turn.
Corners imageCorners(const PinholeCamera& camera, double length) {
  const double right = camera.width - 0.5;  // pixel centres are at integers
  const double bottom = camera.height - 0.5;
  return {length * camera.unproject({-0.5, -0.5}), length * camera.unproject({right, -0.5}),
          length * camera.unproject({right, bottom}), length * camera.unproject({-0.5, bottom})};
}

void addLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to, Marker& marker) {
  marker.points.push_back(toPoint(from));
  marker.points.push_back(toPoint(to));
}

void addFrustum(const SE3& T_map_camera, const Corners& corners, Marker& marker) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    addLine(T_map_camera.translation(), T_map_camera * corners[i], marker);
    addLine(T_map_camera * corners[i], T_map_camera * corners[(i + 1) % corners.size()], marker);
  }
}

void addTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, Marker& marker) {
  for (const Eigen::Vector3d& point : {a, b, c}) marker.points.push_back(toPoint(point));
}

std_msgs::ColorRGBA between(const std_msgs::ColorRGBA& a, const std_msgs::ColorRGBA& b, float share) {
  return color(a.r + share * (b.r - a.r), a.g + share * (b.g - a.g), a.b + share * (b.b - a.b),
               a.a + share * (b.a - a.a));
}

/// Poses of the camera from the start of the exposure to its end.
std::vector<SE3> sweptPoses(const SE3& T_world_odom, const ExposureTrajectory& trajectory) {
  std::vector<SE3> poses;
  for (int i = 0; i <= kSweptParts; ++i) {
    poses.push_back(T_world_odom * trajectory.at(trajectory.exposure * (static_cast<double>(i) / kSweptParts - 0.5)));
  }
  return poses;
}

void addSweep(const std::vector<SE3>& poses, const Corners& corners, Marker& surface, Marker& ways) {
  for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
    const SE3& from = poses[k];
    const SE3& to = poses[k + 1];
    const float share = (static_cast<float>(k) + 0.5F) / static_cast<float>(kSweptParts);
    addLine(from.translation(), to.translation(), ways);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector3d& a = corners[i];
      const Eigen::Vector3d& b = corners[(i + 1) % corners.size()];
      addLine(from * a, to * a, ways);
      addTriangle(from * a, from * b, to * b, surface);
      addTriangle(from * a, to * b, to * a, surface);
    }
    ways.colors.resize(ways.points.size(), between(startColor(1.0F), endColor(1.0F), share));
    surface.colors.resize(surface.points.size(), between(startColor(0.45F), endColor(0.45F), share));
  }
}

Marker makeMarker(const std_msgs::Header& header, const std::string& ns, int id, int type, double width) {
  Marker marker;
  marker.header = header;
  marker.ns = ns;
  marker.id = id;
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = type == Marker::TRIANGLE_LIST ? 1.0 : width;
  marker.scale.y = marker.scale.z = 1.0;
  marker.color = color(1.0F, 1.0F, 1.0F, 1.0F);
  return marker;
}

}  // namespace

visualization_msgs::MarkerArray makeMarkers(const MeasuredMotion& motion, const Reference& reference,
                                            const std::string& map_frame) {
  const TrackedFrame& tracked = *motion.tracked;
  const PinholeCamera& camera = tracked.frame->pyramid.level(0).camera;
  const double unit = medianDepth(reference);
  const Corners corners = imageCorners(camera, kFrustumLength * unit);
  const std::vector<SE3> poses = sweptPoses(motion.T_base_camera * motion.T_map_odom, exposureInOdom(motion));

  std_msgs::Header header;
  header.frame_id = map_frame;
  header.stamp = toRosTime(tracked.frame->mid_exposure_ns);
  Marker start = makeMarker(header, "exposure", 0, Marker::LINE_LIST, kLineWidth * unit);
  Marker end = makeMarker(header, "exposure", 1, Marker::LINE_LIST, kLineWidth * unit);
  Marker surface = makeMarker(header, "exposure", 2, Marker::TRIANGLE_LIST, 1.0);
  Marker ways = makeMarker(header, "exposure", 3, Marker::LINE_LIST, 0.5 * kLineWidth * unit);
  Marker keyframes = makeMarker(header, "keyframes", 0, Marker::LINE_LIST, 0.5 * kLineWidth * unit);
  start.color = startColor(1.0F);
  end.color = endColor(1.0F);
  keyframes.color = color(0.35F, 0.6F, 1.0F, 0.9F);
  addFrustum(poses.front(), corners, start);
  addFrustum(poses.back(), corners, end);
  addSweep(poses, corners, surface, ways);
  const Corners keyframe_corners = imageCorners(camera, kKeyframeLength * unit);
  for (const auto& [id, T_map_keyframe] : reference.T_map_keyframe) {
    addFrustum(motion.T_base_camera * T_map_keyframe, keyframe_corners, keyframes);
  }
  visualization_msgs::MarkerArray markers;
  markers.markers = {start, end, surface, ways};
  if (!keyframes.points.empty()) markers.markers.push_back(keyframes);
  return markers;
}

visualization_msgs::MarkerArray deleteMarkers() {
  visualization_msgs::MarkerArray markers;
  markers.markers.resize(1);
  markers.markers.front().action = Marker::DELETEALL;
  return markers;
}

}  // namespace mba_vo
