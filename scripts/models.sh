#!/usr/bin/env bash
# What the models of blur and of the rolling shutter are good for: the same runs with and without them, side by side.
#
#   scripts/models.sh [--data DIR] [--output DIR] [--bin DIR]
#
#   --data DIR       folder with the sequences shake and kitchen (../shared/data)
#   --output DIR     folder for the results (output/models)
#   --bin DIR        folder of the programs (devel/lib/mba_vo)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

data=../shared/data
output=output/models
bin=devel/lib/mba_vo
while [ $# -gt 0 ]; do
  case "$1" in
    --data) data=${2:?--data needs a folder}; shift ;;
    --output) output=${2:?--output needs a folder}; shift ;;
    --bin) bin=${2:?--bin needs a folder}; shift ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) echo "models.sh: '$1'?" >&2; exit 2 ;;
  esac
  shift
done

source scripts/figures.sh

# run NAME SEQUENCE GROUNDTRUTH ESTIMATE OPTION...: options of mba_vo_offline; the last two are names of files
run() {
  local folder=$output/$1 sequence=$data/$2 truth=$data/$2/$3 estimate=$output/$1/$4
  shift 4
  mkdir -p "$folder"
  "$bin/mba_vo_offline" "$sequence" --output "$folder" --deterministic "$@" >"$folder/log.txt" 2>&1
  "$bin/mba_vo_evaluate" --groundtruth "$truth" --estimate "$estimate" --frames "$folder/frames.csv" \
    --yaml "$folder/evaluation.yaml" >>"$folder/log.txt"
}

# value NAME KEY FIELD: one figure of a line of the evaluation; KEY as figure's PATH
value() {
  figure "$output/$1/evaluation.yaml" "$2" "$3"
}

echo 'shake: motion within the exposure against its true start and end poses, medians'
printf '%-16s %10s %16s %14s\n' 'blur model' 'ATE [m]' 'direction [deg]' 'length ratio'
for model in on off; do
  exposure=auto
  if [ $model = off ]; then exposure=0; fi
  run "shake_$model" shake groundtruth_exposure.txt exposure_trajectory.txt --exposure $exposure
  printf '%-16s %10.4f %16.1f %14.3f\n' $model "$(value shake_$model ate rmse)" \
    "$(value shake_$model exposure.direction median)" "$(value shake_$model exposure.length_ratio median)"
done

mkdir -p "$output"
printf 'mapper:\n  refine_calibration: false\n' >"$output/as_told.yaml"
printf '\nkitchen: exposure unknown, rolling shutter\n'
printf '%-28s %10s %14s\n' 'calibration' 'ATE [m]' 'exposure [ms]'
for calibration in 'as told' 'row time of 65 us' 'corrected by itself'; do
  case "$calibration" in
    'as told') options=(--config "$output/as_told.yaml") ;;
    'row time of 65 us') options=(--config "$output/as_told.yaml" --row-time 65e-6) ;;
    *) options=() ;;
  esac
  name=kitchen_${calibration// /_}
  run "$name" kitchen groundtruth.txt trajectory.txt "${options[@]}"
  printf '%-28s %10.4f %14.1f\n' "$calibration" "$(value "$name" ate rmse)" \
    "$(awk -F, '$4 > 0 { e = $4 } END { print 1e3 * e }' "$output/$name/frames.csv")"
done
echo 'for comparison, without either: DSO 0.22, ORB-SLAM3 0.035'
