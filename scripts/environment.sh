# shellcheck shell=bash
# Sourced by the other scripts in the repository's root: the ROS environment of the build made there.

# With no master named, everything stays on this machine, whatever its host name resolves to.
if [ -z "${ROS_MASTER_URI:-}" ]; then export ROS_IP=${ROS_IP:-127.0.0.1}; fi
set +u  # catkin's script reads variables that are not set
# shellcheck source=/dev/null
source devel/setup.bash
set -u
