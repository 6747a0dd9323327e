#!/usr/bin/env bash
# Takes the picture in the README: simulates a blurred sequence, plays it through the ROS nodes with rviz on a virtual
# screen, and writes what rviz shows.
#
#   scripts/screenshot.sh [--no-install] [--bag FILE | --webcam FILE] [--after S] [--rate R] [--output FILE]
#                         [--animation FILE]
#
#   --no-install    the dependencies are there already, and so is the build
#   --bag FILE      of mba_vo_simulate or mba_vo_make_bag, in place of a simulated one
#   --webcam FILE   starts webcam.launch with this video, image folder or sequence folder as the camera, again and again,
#                   in place of a bag; what has no calibration gets one of 60 degrees of view
#   --after S       seconds between the first deblurred keyframe and the picture (5)
#   --rate R        speed of the bag, not of --webcam (0.5): a virtual screen has no graphics card
#   --output FILE   the picture (docs/images/rviz.png)
#   --animation FILE  besides, some seconds from then on, small, as a GIF
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

install=true
bag=
webcam=
after=5
rate=0.5
picture=docs/images/rviz.png
animation=
while [ $# -gt 0 ]; do
  case "$1" in
    --no-install) install=false ;;
    --bag) bag=${2:?--bag needs a file}; shift ;;
    --webcam) webcam=${2:?--webcam needs a file}; shift ;;
    --after) after=${2:?--after needs seconds}; shift ;;
    --rate) rate=${2:?--rate needs a factor}; shift ;;
    --output) picture=${2:?--output needs a file}; shift ;;
    --animation) animation=${2:?--animation needs a file}; shift ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) echo "screenshot.sh: '$1': see --help" >&2; exit 2 ;;
  esac
  shift
done

if $install; then
  scripts/install_dependencies.sh --with-screenshot
  scripts/build.sh --no-install -DMBA_VO_TESTS=OFF
fi
source scripts/environment.sh
work=$(mktemp -d)
launched=
screen=
end() {
  for process in $launched $screen; do kill "$process" 2>/dev/null || true; done
  wait
  rm -rf "$work"
}
trap end EXIT

if [ -n "$webcam" ]; then
  start=(webcam.launch device:="$(realpath "$webcam")" loop:=true field_of_view:=60 output:="$work/run")
else
  if [ -z "$bag" ]; then
    bag=$work/sequence.bag
    devel/lib/mba_vo/mba_vo_simulate --output "$work/sequence" --bag "$bag" --shake 0.7 --duration 15
  fi
  start=(mba_vo.launch bag:="$(realpath "$bag")" output:="$work/run" rate:="$rate" rviz:=true)
fi
mkdir -p "$(dirname "$picture")"

size=1600x900
exec 3>"$work/display"
Xvfb -displayfd 3 -screen 0 ${size}x24 -nolisten tcp 2>"$work/xvfb.log" &
screen=$!
for _ in $(seq 100); do [ -s "$work/display" ] && break; sleep 0.1; done
DISPLAY=:$(cat "$work/display")
export DISPLAY LIBGL_ALWAYS_SOFTWARE=1

roslaunch mba_vo "${start[@]}" >"$work/launch.log" 2>&1 &
launched=$!
for _ in 1 2 3 4 5 6; do  # until there is a master, and somebody publishes
  if timeout 60 rostopic echo -n 1 /mba_vo/keyframe/sharp/header >/dev/null 2>&1; then break; fi
  sleep 2
done
sleep "$after"
import -window root "$work/shot.png"
convert "$work/shot.png" -dither None -colors 200 -define png:compression-level=9 "$picture"
echo "$picture"
if [ -n "$animation" ]; then
  for i in $(seq -w 24); do
    import -window root -resize 640x "$work/frame-$i.png"
    sleep 0.2
  done
  convert -delay 20 -loop 0 "$work"/frame-*.png -dither None -colors 64 -layers Optimize "$animation"
  echo "$animation"
fi
