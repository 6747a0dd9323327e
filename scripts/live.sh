#!/usr/bin/env bash
# Plays the development sequences as bags at real speed through the ROS nodes, and prints accuracy, latency and what was
# shed (docs/results.md).
#
#   scripts/live.sh [--data DIR] [--output DIR] [SEQUENCE...]
#
#   --data DIR     folder with the sequences (../shared/data)
#   --output DIR   folder for bags and trajectories (output/live)
#   SEQUENCE       desk shake kitchen (all of them)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

data=../shared/data
output=output/live
sequences=()
while [ $# -gt 0 ]; do
  case "$1" in
    --data) data=${2:?--data needs a folder}; shift ;;
    --output) output=${2:?--output needs a folder}; shift ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) sequences+=("$1") ;;
  esac
  shift
done
if [ ${#sequences[@]} -eq 0 ]; then sequences=(desk shake kitchen); fi
mkdir -p "$output"
output=$(realpath "$output")

source scripts/environment.sh
bin=devel/lib/mba_vo

for sequence in "${sequences[@]}"; do
  folder=$output/$sequence
  mkdir -p "$folder"
  rm -f "$folder"/*trajectory.*
  # A bag cannot hold the time 0, at which some sequences begin.
  offset=$(awk '!/^#/ {print ($2 < 1 ? 1 : 0); exit}' "$data/$sequence/times.txt")
  awk -v offset="$offset" '/^#/ || offset == 0 {print; next} {$1 = sprintf("%.9f", $1 + offset); print}' \
    "$data/$sequence/groundtruth.txt" >"$folder/groundtruth.txt"
  if [ ! -s "$folder/sequence.bag" ]; then
    "$bin/mba_vo_make_bag" "$data/$sequence" --output "$folder/sequence.bag" --time-offset "$offset" >/dev/null
  fi
  scripts/live_report.py >"$folder/report.txt" 2>&1 &
  report=$!
  roslaunch mba_vo demo.launch bag:="$folder/sequence.bag" output:="$folder" >"$folder/log.txt" 2>&1 || true
  kill "$report" 2>/dev/null || true
  wait "$report" || true
  printf '\n== %s\n' "$sequence"
  cat "$folder/report.txt"
  "$bin/mba_vo_evaluate" --groundtruth "$folder/groundtruth.txt" --estimate "$folder/trajectory.txt" \
    --plot "$folder/trajectory.png"
done
