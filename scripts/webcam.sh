#!/usr/bin/env bash
# What an ordinary camera costs: renders recorded motions as an ideal camera and as a webcam see them, and prints what was
# published (mba_vo_offline --live, one pass) by each, and by the webcam when it is started the second time
# (docs/decisions/2026-11-23-ordinary-cameras.md).
#
#   scripts/webcam.sh [--motions DIR] [--output DIR] [--cameras LIST] [--starts LIST] [--duration S] [--seed N] [--bin DIR]
#                     [MOTION...]
#
#   --motions DIR   folder with the recorded motions (../shared/motions)
#   --output DIR    folder for sequences, what was learnt, and trajectories (output/webcam); sequences found there are
#                   used again. Rendering one takes minutes
#   --cameras LIST  of: ideal vignette gamma focal hidden rolling told webcam ("ideal webcam")
#   --starts LIST   images to leave out at the beginning ("0 10 20"); of several the median is printed
#   --duration S    length of the sequences (12)
#   --seed N        of the rooms (50)
#   --bin DIR       folder of the programs (devel/lib/mba_vo)
#   MOTION          hand_desk head_room6 hand_office drone_v202 head_room2 head_room3 head_room4 (the first three)
#
# All cameras: 640x480, 30 Hz, exposure between 6 and 24 ms. Ideal: global shutter, linear, all told. The others
# differ from it by one thing: light falling to 65 % in the corners; gamma 2.2 not told; focal length 1 % wrong; exposure
# not told; rolling shutter of 26 ms not told, or told. The webcam has all of them, JPEG 92, and a gain that makes up for the
# exposure but for 15 %.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

motions=../shared/motions
output=output/webcam
cameras="ideal webcam"
starts="0 10 20"
duration=12
seed=50
bin=devel/lib/mba_vo
names=()
while [ $# -gt 0 ]; do
  case "$1" in
    --motions) motions=${2:?--motions needs a folder}; shift ;;
    --output) output=${2:?--output needs a folder}; shift ;;
    --cameras) cameras=${2:?--cameras needs a list}; shift ;;
    --starts) starts=${2:?--starts needs a list of numbers}; shift ;;
    --duration) duration=${2:?--duration needs seconds}; shift ;;
    --seed) seed=${2:?--seed needs a number}; shift ;;
    --bin) bin=${2:?--bin needs a folder}; shift ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) names+=("$1") ;;
  esac
  shift
done
if [ ${#names[@]} -eq 0 ]; then names=(hand_desk head_room6 hand_office); fi
read -r -a cameras <<<"$cameras"
read -r -a starts <<<"$starts"

row_time=0.00005417  # 480 rows in 26 ms [s]

# where a motion is entered [s], and the seed of the room around it
place() {
  case "$1" in
    hand_desk) echo --start 3 --scene-seed $((seed + 1)) ;;
    head_room6) echo --start 10 --scene-seed $((seed + 2)) ;;
    hand_office) echo --start 20 --scene-seed $((seed + 3)) ;;
    drone_v202) echo --start 12 --scene-seed $((seed + 4)) ;;
    head_room2) echo --start 5 --scene-seed $((seed + 11)) ;;
    head_room3) echo --start 8 --scene-seed $((seed + 12)) ;;
    head_room4) echo --start 6 --scene-seed $((seed + 13)) ;;
    *) echo "webcam.sh: motion '$1': must be hand_desk, head_room6, hand_office, drone_v202 or head_room2 to head_room4" >&2; exit 2 ;;
  esac
}

# what a camera has that the ideal one has not
faults() {
  case "$1" in
    ideal) ;;
    vignette) echo --vignette 0.35 ;;
    gamma) echo --gamma 2.2 ;;
    focal) echo --calibration-focal-error 0.01 ;;
    hidden) echo --hide-exposure ;;
    rolling | told) echo --row-time "$row_time" ;;
    webcam) echo "$(faults vignette) $(faults gamma) $(faults focal) $(faults hidden) $(faults rolling) --jpeg 92" \
      --auto-gain --gain-error 0.15 ;;
    *) echo "webcam.sh: camera '$1': must be ideal, vignette, gamma, focal, hidden, rolling, told or webcam" >&2; exit 2 ;;
  esac
}

render() {
  local sequence=$output/sequences/$1_$2 options
  if [ -s "$sequence/blur_px.txt" ]; then return 0; fi  # the last thing to be written
  options="$(place "$1") $(faults "$2")"
  read -r -a options <<<"$options"
  "$bin/mba_vo_simulate" --motion "$motions/$1.txt" --width 640 --height 480 --fx 460 --rate 30 --duration "$duration" --max-step 1 \
    --exposure-min 0.006 --exposure-max 0.024 --exposure-period 5 "${options[@]}" --no-cache --overwrite --output "$sequence" \
    >/dev/null
}

# run_again NAME SEQUENCE: started the second time, with what the run from the first image has learnt
run_again() {
  local learnt=$output/$1.learnt.yaml config=$output/$1.config.yaml
  rm -f "$learnt" "$learnt.kept"
  echo "image: {learnt_file: $(realpath -m "$learnt")}" >"$config"
  run_and_print "$1-learns" "$2" --live --config "$config"
  cp "$learnt" "$learnt.kept"
  for start in "${starts[@]}"; do
    cp "$learnt.kept" "$learnt"
    run_and_print "$1-2nd-$start" "$2" --live --skip "$start" --config "$config"
  done
  print_median "$1-2nd" "${starts[@]/#/$1-2nd-}"
}

source scripts/figures.sh
mkdir -p "$output/sequences"
for name in "${names[@]}"; do
  for camera in "${cameras[@]}"; do render "$name" "$camera"; done
done
print_header
for name in "${names[@]}"; do
  for camera in "${cameras[@]}"; do
    options=()
    if [ "$camera" = told ]; then options=(--row-time "$row_time"); fi
    run_starts "${name}_$camera" "$output/sequences/${name}_$camera" "${options[@]}"
    if [ "$camera" = webcam ]; then run_again "${name}_$camera" "$output/sequences/${name}_$camera"; fi
  done
done
