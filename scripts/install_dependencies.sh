#!/usr/bin/env bash
# Installs what mba_vo needs on Debian 12, all of it from Debian's own archive. Does nothing where all is there already.
#
#   scripts/install_dependencies.sh [--no-ros] [--with-rviz] [--with-screenshot] [--with-checks]
#
#   --no-ros           only what the core and its programs need (cmake -DMBA_VO_ROS=OFF)
#   --with-rviz        also rviz, to look at the live odometry
#   --with-screenshot  also what scripts/screenshot.sh needs
#   --with-checks      also what .ci/run checks with: formatter, linters, compiler cache
set -euo pipefail

core=(
  cmake g++ make
  libcli11-dev libeigen3-dev libgmock-dev libgtest-dev libopencv-dev libsuitesparse-dev libtbb-dev libyaml-cpp-dev
  libcereal-dev zlib1g-dev  # maps in files
  python3-matplotlib python3-yaml  # mba_vo_benchmark
  python3-numpy python3-opencv  # scripts that measure
)
ros=(
  # to build
  catkin libcamera-info-manager-dev libcv-bridge-dev libdiagnostic-updater-dev libimage-transport-dev libnav-msgs-dev
  libnodeletlib-dev librosbag-dev libroscpp-dev libroslib-dev librostest-dev libsensor-msgs-dev libstd-srvs-dev libtf2-ros-dev
  libvisualization-msgs-dev pluginlib-dev ros-geometry-msgs ros-message-generation ros-message-runtime ros-std-msgs
  # to run
  libnodeletlib-tools python3-diagnostic-msgs python3-genpy python3-geometry-msgs python3-nav-msgs python3-rosbag
  python3-roslaunch python3-rosmsg python3-rosnode python3-rosparam python3-rospy python3-rosservice python3-rostest
  python3-rostopic python3-sensor-msgs python3-std-msgs python3-std-srvs python3-tf2-msgs python3-visualization-msgs
  rosbash rosout rospack-tools tf2-tools
)
rviz=(rviz)
screenshot=(rviz imagemagick libgl1-mesa-dri xvfb)
checks=(catkin-lint ccache clang-format clang-tidy ninja-build shellcheck)

usage() { sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; }

with_ros=true
extras=()
for argument in "$@"; do
  case "$argument" in
    --no-ros) with_ros=false ;;
    --with-rviz) extras+=("${rviz[@]}") ;;
    --with-screenshot) extras+=("${screenshot[@]}") ;;
    --with-checks) extras+=("${checks[@]}") ;;
    -h | --help) usage; exit 0 ;;
    *) echo "install_dependencies.sh: '$argument': must be --no-ros, --with-rviz, --with-screenshot or --with-checks" >&2; exit 2 ;;
  esac
done

wanted=("${core[@]}" "${extras[@]}")
if $with_ros; then wanted+=("${ros[@]}"); fi

missing=()
for package in "${wanted[@]}"; do
  state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$state" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "All ${#wanted[@]} packages are installed."
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "install_dependencies.sh: run this as root, or install sudo" >&2; exit 1; }
  as_root=(sudo)
fi
echo "Installing ${missing[*]}"
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -q --no-install-recommends "${missing[@]}" </dev/null
