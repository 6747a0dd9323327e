#!/usr/bin/env bash
# What the sensor costs: renders recorded motions, makes of the images what other sensors would have seen of the same
# light, and prints what was published (mba_vo_offline --live, one pass) with each.
#
#   scripts/sensors.sh [--motions DIR] [--output DIR] [--sensors LIST] [--starts LIST] [--bin DIR] [MOTION...]
#
#   --motions DIR   folder with the recorded motions (../shared/motions)
#   --output DIR    folder for sequences and trajectories (output/sensors); sequences found there are used again
#   --sensors LIST  of: clean bits12 dark dark12 bayer jpeg60 bright small fast ("clean bits12 dark bayer jpeg60 small")
#   --starts LIST   images to leave out at the beginning ("0 10 20"); of several the median is printed
#   --bin DIR       folder of the programs (devel/lib/mba_vo)
#   MOTION          hand_desk head_room6 (both)
#
# clean: 640x480, 30 Hz, 8 s, exposure between 6 and 24 ms, noise of 1 grey level. The others differ from it by one
# thing: bits12, 12 bits in 16; dark, mean grey level 20 with noise 2; dark12, as dark, in 12 bits that are as clean as the
# clean ones; bayer, raw and mixed to grey; jpeg60, compressed; bright, twice the light, so that much of it is
# saturated; small, 320x240; fast, 1280x720 at 60 Hz with half the exposure and half the length.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

motions=../shared/motions
output=output/sensors
sensors="clean bits12 dark bayer jpeg60 small"
starts="0 10 20"
bin=devel/lib/mba_vo
names=()
while [ $# -gt 0 ]; do
  case "$1" in
    --motions) motions=${2:?--motions needs a folder}; shift ;;
    --output) output=${2:?--output needs a folder}; shift ;;
    --sensors) sensors=${2:?--sensors needs a list}; shift ;;
    --starts) starts=${2:?--starts needs a list of numbers}; shift ;;
    --bin) bin=${2:?--bin needs a folder}; shift ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) names+=("$1") ;;
  esac
  shift
done
if [ ${#names[@]} -eq 0 ]; then names=(hand_desk head_room6); fi
read -r -a sensors <<<"$sensors"
read -r -a starts <<<"$starts"

# where a motion is entered [s], and the seed of the room around it
place() {
  case "$1" in
    hand_desk) echo --start 3 --scene-seed 51 ;;
    head_room6) echo --start 10 --scene-seed 52 ;;
    *) echo "sensors.sh: motion '$1': must be hand_desk or head_room6" >&2; exit 2 ;;
  esac
}

camera() {
  case "$1" in
    clean) echo --width 640 --height 480 --fx 460 --rate 30 --duration 8 --exposure-min 0.006 --exposure-max 0.024 ;;
    small) echo --width 320 --height 240 --fx 230 --rate 30 --duration 8 --exposure-min 0.006 --exposure-max 0.024 ;;
    fast) echo --width 1280 --height 720 --fx 920 --rate 60 --duration 4 --exposure-min 0.003 --exposure-max 0.012 ;;
  esac
}

render() {
  local sequence=$output/sequences/$1_$2 options
  if [ -s "$sequence/blur_px.txt" ]; then return 0; fi  # the last thing to be written
  options="$(place "$1") $(camera "$2")"
  read -r -a options <<<"$options"
  "$bin/mba_vo_simulate" --motion "$motions/$1.txt" --max-step 1 --exposure-period 5 "${options[@]}" --no-cache --overwrite \
    --output "$sequence" >/dev/null
}

make_sequence() {
  case "$2" in
    clean | small | fast) render "$1" "$2"; return ;;
  esac
  render "$1" clean
  if [ -s "$output/sequences/$1_$2/blur_px.txt" ]; then return 0; fi
  /usr/bin/python3 scripts/sensor_twin.py "$2" "$output/sequences/$1_clean" "$output/sequences/$1_$2"
}

source scripts/figures.sh
mkdir -p "$output/sequences"
for name in "${names[@]}"; do
  for sensor in "${sensors[@]}"; do make_sequence "$name" "$sensor"; done
done
print_header
for name in "${names[@]}"; do
  for sensor in "${sensors[@]}"; do
    run_starts "${name}_$sensor" "$output/sequences/${name}_$sensor"
  done
done
