#!/usr/bin/env bash
# Plays the development sequences as bags at real speed through the ROS nodes, and prints what was published when it was
# published, then what was saved in the end (docs/decisions/2026-11-23-live-in-simulated-time.md).
#
#   scripts/live.sh [--data DIR] [--output DIR] [--cores LIST] [--player-cores LIST] [--config FILE] [--runs N] [SEQUENCE...]
#
#   --data DIR     folder with the sequences (../shared/data)
#   --output DIR   folder for bags and trajectories (output/live)
#   --cores LIST   of the nodes, as for taskset, for example 0; all of them
#   --player-cores LIST   of the player of the bag; as the nodes
#   --config FILE  options of the nodes (config/default.yaml)
#   --runs N       times that each is played (1); of several the medians are printed
#   SEQUENCE       desk shake kitchen spin, or another folder in --data (desk shake kitchen)
#
# A run beside which the machine itself was slow, as one that it shares with others may be, is marked: run it again.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

data=../shared/data
output=output/live
cores=$(taskset --cpu-list --pid $$ | sed 's/.*: //')
player_cores=
config=config/default.yaml
count=1
sequences=()
while [ $# -gt 0 ]; do
  case "$1" in
    --data) data=${2:?--data needs a folder}; shift ;;
    --output) output=${2:?--output needs a folder}; shift ;;
    --cores) cores=${2:?--cores needs a list}; shift ;;
    --player-cores) player_cores=${2:?--player-cores needs a list}; shift ;;
    --config) config=${2:?--config needs a file}; shift ;;
    --runs) count=${2:?--runs needs a number}; shift ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) sequences+=("$1") ;;
  esac
  shift
done
if [ ${#sequences[@]} -eq 0 ]; then sequences=(desk shake kitchen); fi
mkdir -p "$output"
output=$(realpath "$output")
config=$(realpath "$config")

source scripts/environment.sh
bin=devel/lib/mba_vo

source scripts/figures.sh

# fixed_work: how long the cores of the nodes take for it [ms]
fixed_work() {
  local begin
  begin=$(date +%s%N)
  for ((core = 0; core < $(taskset --cpu-list "$cores" nproc); ++core)); do
    taskset --cpu-list "$cores" awk 'BEGIN { for (i = 0; i < 24000000; ++i) sum += i }' &
  done
  wait
  echo $((($(date +%s%N) - begin) / 1000000))
}

quickest=$(fixed_work)

# mark_slow: says so if the machine is slower by a half than it was at its quickest
mark_slow() {
  local now
  now=$(fixed_work)
  if [ "$now" -lt "$quickest" ]; then quickest=$now; fi
  if [ $((2 * now)) -gt $((3 * quickest)) ]; then
    echo "  the machine is slow $1: $now ms for what it did in $quickest ms"
  fi
}

# play NAME SEQUENCE: one run, into $output/NAME
play() {
  local folder=$output/$1 bag=$output/$2.bag truth=$output/$2
  mkdir -p "$folder" "$truth"
  rm -f "$folder"/*
  # A bag cannot hold the time 0, at which some sequences begin.
  local offset
  offset=$(awk '!/^#/ {print ($2 < 1 ? 1 : 0); exit}' "$data/$2/times.txt")
  awk -v offset="$offset" '/^#/ || offset == 0 {print; next} {$1 = sprintf("%.9f", $1 + offset); print}' \
    "$data/$2/groundtruth.txt" >"$truth/groundtruth.txt"
  if [ ! -s "$bag" ]; then
    "$bin/mba_vo_make_bag" "$data/$2" --output "$bag" --time-offset "$offset" >/dev/null
  fi
  mark_slow "before $1"
  taskset --cpu-list "$cores" roslaunch mba_vo demo.launch bag:="$bag" output:="$folder" config:="$config" \
    player_prefix:="taskset --cpu-list ${player_cores:-$cores}" >"$folder/log.txt" 2>&1 || true
  mark_slow "after $1"
  if ! evaluate "$truth" "$folder" >"$folder/evaluation.txt" 2>&1; then
    printf '%-20s failed: %s\n' "$1" "$(tail -n 1 "$folder/evaluation.txt")"
    return 0
  fi
  print_run "$1" "$folder"
}

print_header
for sequence in "${sequences[@]}"; do
  names=()
  for ((run = 1; run <= count; ++run)); do
    names+=("$sequence-live-$run")
    play "${names[-1]}" "$sequence"
  done
  if [ "$count" -gt 1 ]; then print_median "$sequence" "${names[@]}"; fi
done
