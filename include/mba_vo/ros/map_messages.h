#pragma once

#include <string>
#include <vector>

#include <nav_msgs/Path.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>

#include "mba_vo/mapping/mapper.h"

namespace mba_vo {

/// Poses of the base at mid-exposure in the newest map, by time; those of earlier maps have other coordinates.
nav_msgs::Path makePath(const std::vector<TrajectoryEntry>& trajectory, const SE3& T_base_camera,
                        const std::string& map_frame, const ros::Time& stamp);

/// Points in the map with fields x, y, z and intensity [grey levels].
sensor_msgs::PointCloud2 makePointCloud(const std::vector<MapPoint>& points, const SE3& T_base_camera,
                                        const std::string& map_frame, const ros::Time& stamp);

/// Sharp image of a keyframe as mono8; invalid pixels are black.
sensor_msgs::ImagePtr makeKeyframeImage(const ImagePyramid& pyramid, const std::string& camera_frame,
                                        const ros::Time& stamp);

}  // namespace mba_vo
