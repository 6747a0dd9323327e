// Tracker and mapper in one process, for rosrun. All names are those of this node: ~image, ~odometry, ~reset, ...
#include <exception>

#include <nodelet/loader.h>
#include <ros/ros.h>

namespace {

/// Remappings given on the command line are relative to this node's parent (image:=/camera/image_raw); the nodelets
/// ask for the names below the node. Both forms shall work.
ros::M_string remappingsBelow(const std::string& ns) {
  ros::M_string remappings = ros::names::getRemappings();
  for (const auto& [from, to] : ros::names::getUnresolvedRemappings()) {
    if (!from.empty() && from[0] != '/' && from[0] != '~') {
      remappings[ns + "/" + from] = ros::names::resolve(to);
    }
  }
  return remappings;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "mba_vo");
  try {
    const std::string ns = ros::this_node::getName();
    const ros::M_string remappings = remappingsBelow(ns);
    nodelet::Loader loader(false);
    // The mapper first, so that no tracked frame is missed.
    if (!loader.load(ns + "/mapping", "mba_vo/Mapper", remappings, {}) ||
        !loader.load(ns + "/tracking", "mba_vo/Tracker", remappings, {})) {
      return 1;
    }
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    return 1;
  }
  return 0;
}
