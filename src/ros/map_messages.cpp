#include "mba_vo/ros/map_messages.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include "mba_vo/ros/conversions.h"

namespace mba_vo {

nav_msgs::Path makePath(const std::vector<TrajectoryEntry>& trajectory, const SE3& T_base_camera,
                        const std::string& map_frame, const ros::Time& stamp) {
  nav_msgs::Path path;
  path.header.frame_id = map_frame;
  path.header.stamp = stamp;
  for (const TrajectoryEntry& entry : trajectory) {
    if (entry.map_id != trajectory.back().map_id) {
      continue;
    }
    geometry_msgs::PoseStamped pose;
    pose.header.frame_id = map_frame;
    pose.header.stamp = toRosTime(entry.mid_exposure_ns);
    pose.pose = toPoseMsg(toBaseWorld(entry.trajectory.T_reference_mid, T_base_camera));
    path.poses.push_back(pose);
  }
  return path;
}

sensor_msgs::PointCloud2 makePointCloud(const std::vector<MapPoint>& points, const SE3& T_base_camera,
                                        const std::string& map_frame, const ros::Time& stamp) {
  sensor_msgs::PointCloud2 cloud;
  cloud.header.frame_id = map_frame;
  cloud.header.stamp = stamp;
  sensor_msgs::PointCloud2Modifier modifier(cloud);
  modifier.setPointCloud2Fields(4, "x", 1, sensor_msgs::PointField::FLOAT32, "y", 1, sensor_msgs::PointField::FLOAT32,
                                "z", 1, sensor_msgs::PointField::FLOAT32, "intensity", 1,
                                sensor_msgs::PointField::FLOAT32);
  modifier.resize(points.size());
  sensor_msgs::PointCloud2Iterator<float> x(cloud, "x"), y(cloud, "y"), z(cloud, "z"), intensity(cloud, "intensity");
  for (const MapPoint& point : points) {
    const Eigen::Vector3f position = (T_base_camera * point.position_map).cast<float>();
    *x = position.x();
    *y = position.y();
    *z = position.z();
    *intensity = point.intensity;
    ++x, ++y, ++z, ++intensity;
  }
  return cloud;
}

sensor_msgs::ImagePtr makeKeyframeImage(const ImagePyramid& pyramid, const std::string& camera_frame,
                                        const ros::Time& stamp) {
  cv::Mat1f intensity = pyramid.level(0).intensity.clone();
  cv::patchNaNs(intensity, 0.0);
  cv_bridge::CvImage image;
  image.header.frame_id = camera_frame;
  image.header.stamp = stamp;
  image.encoding = sensor_msgs::image_encodings::MONO8;
  intensity.convertTo(image.image, CV_8U);
  return image.toImageMsg();
}

}  // namespace mba_vo
