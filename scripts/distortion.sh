#!/usr/bin/env bash
# Simulates one sequence through several lenses, runs mba_vo offline over each from five starts, and prints the figures
# of every run and the median error of every lens.
#
#   scripts/distortion.sh [--output DIR] [--bin DIR]
#
#   --output DIR     folder for sequences and trajectories (output/distortion)
#   --bin DIR        folder of the programs (devel/lib/mba_vo)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

output=output/distortion
bin=devel/lib/mba_vo
while [ $# -gt 0 ]; do
  case "$1" in
    --output) output=${2:?--output needs a folder}; shift ;;
    --bin) bin=${2:?--bin needs a folder}; shift ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) echo "distortion.sh: '$1': must be --output or --bin" >&2; exit 2 ;;
  esac
  shift
done

source scripts/figures.sh

# lens NAME OPTION...: options of mba_vo_simulate
lens() {
  local name=$1 skip
  shift
  "$bin/mba_vo_simulate" --output "$output/sequences/$name" --overwrite --scene-seed 3 --trajectory-seed 3 --shake 0.5 \
    "$@" >/dev/null
  for skip in 0 5 10 15 20; do run_and_print "$name-$skip" "$output/sequences/$name" --skip "$skip"; done
}

lenses=(none plumb_bob equidistant)
print_header
lens none
lens plumb_bob --distortion-model plumb_bob --distortion=-0.28,0.07,0.0002,0.00002,0
lens equidistant --distortion-model equidistant --distortion=-0.01,0.02,-0.015,0.005
for name in "${lenses[@]}"; do print_median "$name" "$name"-{0,5,10,15,20}; done
