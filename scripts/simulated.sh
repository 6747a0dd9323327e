#!/usr/bin/env bash
# Renders long, shaken walks and prints the odometry's error on them, sharp and blurred (docs/decisions/2026-11-23-fast-turns.md).
#
#   scripts/simulated.sh [--output DIR] [--seeds LIST] [--duration S] [--delay FRAMES] [--starts LIST] [--bin DIR]
#
#   --output DIR     folder for sequences, trajectories and plots (output/simulated); sequences found there are used again
#   --seeds LIST     of scene and trajectory ("11 12 13 14"); rendering takes up to half an hour a seed
#   --duration S     of 20 m [s] (33.3, as fast as `shake`; half of it is a brisk walk)
#   --delay FRAMES   frames until a new keyframe is used: 0 (ideal), 12 (a slow machine)
#   --starts LIST    images to leave out at the beginning ("0 5 10 15 20"); of several the median is printed
#   --bin DIR        folder of the programs (devel/lib/mba_vo)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

output=output/simulated
seeds="11 12 13 14"
duration=33.3
delay=0
starts="0 5 10 15 20"
bin=devel/lib/mba_vo
while [ $# -gt 0 ]; do
  case "$1" in
    --output) output=${2:?--output needs a folder}; shift ;;
    --seeds) seeds=${2:?--seeds needs a list of numbers}; shift ;;
    --duration) duration=${2:?--duration needs seconds}; shift ;;
    --delay) delay=${2:?--delay needs a number}; shift ;;
    --starts) starts=${2:?--starts needs a list of numbers}; shift ;;
    --bin) bin=${2:?--bin needs a folder}; shift ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) echo "simulated.sh: '$1' is no option; see --help" >&2; exit 2 ;;
  esac
  shift
done

source scripts/figures.sh
read -r -a seeds <<<"$seeds"
read -r -a starts <<<"$starts"
for seed in "${seeds[@]}"; do
  folder=$output/sequences/seed-$seed-$duration
  if [ -s "$folder/blur_px.txt" ]; then continue; fi  # the last thing to be written
  "$bin/mba_vo_simulate" --scene-seed "$seed" --trajectory-seed "$seed" --path-length 20 --duration "$duration" --shake 1.2 \
    --sharp --output "$folder" --overwrite
done
print_header
for seed in "${seeds[@]}"; do
  for images in images_sharp images; do
    names=()
    for start in "${starts[@]}"; do
      names+=("seed-$seed-$duration-$images-$start")
      run_and_print "${names[-1]}" "$output/sequences/seed-$seed-$duration" --images "$images" \
        --exposure "$([ "$images" = images ] && echo auto || echo 0)" --reference-delay "$delay" --skip "$start"
    done
    if [ ${#starts[@]} -gt 1 ]; then print_median "seed $seed" "${names[@]}"; fi
  done
done
