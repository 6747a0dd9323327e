#!/usr/bin/env bash
# Recorded motions, each in two rooms: renders 20 s of each (376x240, 25 Hz, exposures of 20 ms, of racing drones 5 ms; all
# told) and prints what was published (mba_vo_offline --live, one pass); then, of each, the length of the path, the error
# as a share of it, and the images without a pose in time after the first one.
#
#   scripts/motions.sh [--motions DIR] [--output DIR] [--bin DIR] [MOTION...]
#
#   --motions DIR   folder with the recorded motions (../shared/motions)
#   --output DIR    folder for sequences and trajectories (output/motions); sequences found there are used again.
#                   Rendering one takes a minute or two
#   --bin DIR       folder of the programs (devel/lib/mba_vo)
#   MOTION          names of files without .txt (the ten of the list below)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

all=(head_room4 drone_v103 racer_forward7 hand_office head_room6 drone_v202 racer_45_2 head_room2 head_room3 hand_desk)
motions=../shared/motions
output=output/motions
bin=devel/lib/mba_vo
names=()
while [ $# -gt 0 ]; do
  case "$1" in
    --motions) motions=${2:?--motions needs a folder}; shift ;;
    --output) output=${2:?--output needs a folder}; shift ;;
    --bin) bin=${2:?--bin needs a folder}; shift ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) names+=("$1") ;;
  esac
  shift
done
if [ ${#names[@]} -eq 0 ]; then names=("${all[@]}"); fi

# render NAME ROOM: entered at another place in each room; hand_desk is hardly longer than 20 s
render() {
  local sequence=$output/sequences/$1_$2 start=$((20 * $2 - 12)) exposure=0.02 seed=300 name
  if [ -s "$sequence/blur_px.txt" ]; then return 0; fi  # the last thing to be written
  if [ "$1" = hand_desk ]; then start=$2; fi
  if [[ $1 == racer* ]]; then exposure=0.005; fi
  for name in "${all[@]}"; do
    seed=$((seed + 10))
    if [ "$name" = "$1" ]; then break; fi
  done
  "$bin/mba_vo_simulate" --motion "$motions/$1.txt" --start "$start" --duration 20 --rate 25 --exposure "$exposure" \
    --width 376 --height 240 --fx 215 --max-step 1 --scene-seed $((seed + $2)) --no-cache --overwrite \
    --output "$sequence" >/dev/null
}

# path_length SEQUENCE [m]
path_length() {
  awk '!/^#/ { if (n++) sum += sqrt(($2 - x) ^ 2 + ($3 - y) ^ 2 + ($4 - z) ^ 2); x = $2; y = $3; z = $4 }
    END { print sum }' "$1/groundtruth.txt"
}

source scripts/figures.sh
mkdir -p "$output/sequences"
print_header
for name in "${names[@]}"; do
  for room in 1 2; do
    render "$name" "$room"
    sequence=$output/sequences/${name}_$room
    run_and_print "${name}_$room" "$sequence" --live
    if [ -s "$output/${name}_$room/evaluation.yaml" ]; then
      awk -v ate="$(figure "$output/${name}_$room/evaluation.yaml" causal.map.ate rmse)" -v path="$(path_length "$sequence")" \
        -v without="$(figure "$output/${name}_$room/evaluation.yaml" causal.availability.missed_after_first percent)" \
        'BEGIN { printf "%-20s | %9.3f %% of a path of %.1f m; %.1f %% of the images without a pose in time after the first\n", "", 100 * ate / path, path, without }'
    fi
  done
done
