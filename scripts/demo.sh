#!/usr/bin/env bash
# Shows mba_vo at work: builds it, simulates a blurred sequence, plays it as a bag through the ROS nodes at real speed,
# and compares the trajectory with the truth.
#
#   scripts/demo.sh [--no-install] [--rviz] [--output DIR] [SIMULATION OPTION...]
#
#   --no-install   the dependencies are there already
#   --rviz         look on with rviz
#   --output DIR   folder for sequence, trajectory and plot (output/demo)
#
# Further options go to mba_vo_simulate (mba_vo_simulate --help), for instance: --duration 20 --scene-seed 7 --shake 1.5
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

output=output/demo
rviz=false
build_options=()
simulation=()
while [ $# -gt 0 ]; do
  case "$1" in
    --no-install) build_options+=(--no-install) ;;
    --rviz) rviz=true ;;
    --output) output=${2:?--output needs a folder}; shift ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) simulation+=("$1") ;;
  esac
  shift
done
mkdir -p "$output"
output=$(realpath "$output")

heading() { printf '\n== %s\n' "$*"; }

heading "Building"
if $rviz && [ ${#build_options[@]} -eq 0 ]; then scripts/install_dependencies.sh --with-rviz; fi
scripts/build.sh "${build_options[@]}" -DMBA_VO_TESTS=OFF
source scripts/environment.sh
bin=devel/lib/mba_vo

heading "Simulating a blurred sequence"
"$bin/mba_vo_simulate" --output "$output/sequence" --overwrite --bag "$output/sequence.bag" "${simulation[@]}"

heading "Playing it through the ROS nodes at real speed"
rm -f "$output"/*trajectory.txt "$output/online_odometry.txt" "$output/frames.csv" "$output/trajectory.png"
roslaunch mba_vo demo.launch bag:="$output/sequence.bag" output:="$output" rviz:=$rviz
[ -s "$output/exposure_trajectory.txt" ] || { echo "demo.sh: the nodes wrote no trajectory" >&2; exit 1; }

heading "Comparing with the truth"
"$bin/mba_vo_evaluate" --groundtruth "$output/sequence/groundtruth_exposure.txt" --run "$output" \
  --plot "$output/trajectory.png"
printf '\nAs published  %s\nSmoothed      %s\n              %s (start and end of every exposure)\nPlot          %s\nSequence      %s\n' \
  "$output/online_trajectory.txt" "$output/trajectory.txt" "$output/exposure_trajectory.txt" "$output/trajectory.png" \
  "$output/sequence.bag"
