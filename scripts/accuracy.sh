#!/usr/bin/env bash
# Runs mba_vo offline over the development sequences and prints one line of figures per run.
#
#   scripts/accuracy.sh [--data DIR] [--output DIR] [--delay FRAMES | --live] [--starts LIST] [--bin DIR] [RUN...]
#
#   --data DIR       folder with the sequences desk, shake and kitchen (../shared/data)
#   --output DIR     folder for trajectories and plots (output/accuracy)
#   --delay FRAMES   frames until a new keyframe is used: 0 (ideal), 12 (a slow machine)
#   --live           as if it ran live, in simulated time (mba_vo_offline --live)
#   --starts LIST    images to leave out at the beginning, for example "0 5 10 15 20"; of several the median is printed
#   --bin DIR        folder of the programs (devel/lib/mba_vo)
#   RUN              desk_sharp desk shake_sharp shake kitchen spin shake_no_blur_model (all of them)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

data=../shared/data
output=output/accuracy
timing=(--reference-delay 0)
starts=0
bin=devel/lib/mba_vo
runs=()
while [ $# -gt 0 ]; do
  case "$1" in
    --data) data=${2:?--data needs a folder}; shift ;;
    --output) output=${2:?--output needs a folder}; shift ;;
    --delay) timing=(--reference-delay "${2:?--delay needs a number}"); shift ;;
    --live) timing=(--live) ;;
    --starts) starts=${2:?--starts needs a list of numbers}; shift ;;
    --bin) bin=${2:?--bin needs a folder}; shift ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) runs+=("$1") ;;
  esac
  shift
done
if [ ${#runs[@]} -eq 0 ]; then runs=(desk_sharp desk shake_sharp shake kitchen spin shake_no_blur_model); fi

# sequence, images and exposure of a run
options() {
  case "$1" in
    desk_sharp) echo desk --images images_sharp --exposure 0 ;;
    desk) echo desk ;;
    shake_sharp) echo shake --images images_sharp --exposure 0 ;;
    shake) echo shake ;;
    kitchen | spin) echo "$1" ;;
    shake_no_blur_model) echo shake --exposure 0 ;;
    *) echo "accuracy.sh: '$1': must be desk_sharp, desk, shake_sharp, shake, kitchen, spin or shake_no_blur_model" >&2; exit 2 ;;
  esac
}

source scripts/figures.sh
read -r -a starts <<<"$starts"
print_header
for run in "${runs[@]}"; do
  arguments=$(options "$run")
  read -r -a arguments <<<"$arguments"
  names=()
  for start in "${starts[@]}"; do
    names+=("$run$([ ${#starts[@]} -eq 1 ] || echo "-$start")")
    run_and_print "${names[-1]}" "$data/${arguments[0]}" "${arguments[@]:1}" "${timing[@]}" --skip "$start"
  done
  if [ ${#starts[@]} -gt 1 ]; then print_median "$run" "${names[@]}"; fi
done
