#!/usr/bin/env bash
# The blur benchmark: renders a room around each recorded motion with exposures from 0 to 30 ms, global and rolling shutter,
# and runs mba_vo_benchmark over them, with the blur model and without it (docs/benchmark.md); writes them for other systems.
#
#   scripts/blur_benchmark.sh [--motions DIR] [--output DIR] [--large] [--takes LIST] [--seed N] [--starts LIST]
#                             [--bin DIR] [--export] [--render-only] [MOTION...]
#
#   --motions DIR   folder with the recorded motions, t tx ty tz qx qy qz qw (../shared/motions)
#   --output DIR    folder for sequences and results (output/blur_benchmark); sequences found there are used again
#   --large         752x480, 10 s, exposures 0 5 10 20 30 ms with both shutters; the small edition has 376x240, 5 s,
#                   0 10 20 30 ms with a global and 0 20 ms with a rolling shutter
#   --takes LIST    shutters and exposures [ms] in place of those of the edition ("global-0 rolling-20")
#   --seed N        of the rooms (60)
#   --starts LIST   images to leave out at the beginning ("0, 10, 20")
#   --bin DIR       folder of the programs (devel/lib/mba_vo)
#   --export        also writes every sequence as folders for DSO, EuRoC and TUM RGB-D with depths and, with ROS, as a bag
#                   (mba_vo_export), and data sheets: blur, light and texture of every image, and of every sequence
#   --render-only   makes the sequences and the experiment file, and runs nothing
#   MOTION          names of files without .txt (all of the folder)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

motions=../shared/motions
output=output/blur_benchmark
large=false
takes=()
seed=60
starts="0, 10, 20"
bin=devel/lib/mba_vo
export=false
render_only=false
names=()
while [ $# -gt 0 ]; do
  case "$1" in
    --motions) motions=${2:?--motions needs a folder}; shift ;;
    --output) output=${2:?--output needs a folder}; shift ;;
    --large) large=true ;;
    --takes) read -ra takes <<<"${2:?--takes needs a list like 'global-0 rolling-20'}"; shift ;;
    --seed) seed=${2:?--seed needs a number}; shift ;;
    --starts) starts=${2:?--starts needs a list of numbers}; shift ;;
    --bin) bin=${2:?--bin needs a folder}; shift ;;
    --export) export=true ;;
    --render-only) render_only=true ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    -*) echo "blur_benchmark.sh: '$1'? --help tells the options" >&2; exit 2 ;;
    *) names+=("$1") ;;
  esac
  shift
done
if [ ${#names[@]} -eq 0 ]; then
  for file in "$motions"/*.txt; do names+=("$(basename "$file" .txt)"); done
fi

if $large; then
  camera=(--width 752 --height 480 --fx 430 --duration 10)
  row_time=0.00005  # 480 rows in 24 ms [s]
  edition=(global-0 global-5 global-10 global-20 global-30 rolling-0 rolling-5 rolling-10 rolling-20 rolling-30)
else
  camera=(--width 376 --height 240 --fx 215 --duration 5)
  row_time=0.0001
  edition=(global-0 global-10 global-20 global-30 rolling-0 rolling-20)
fi
if [ ${#takes[@]} -eq 0 ]; then takes=("${edition[@]}"); fi
for take in "${takes[@]}"; do
  if [[ ! $take =~ ^(global|rolling)-[0-9]+$ ]]; then
    echo "blur_benchmark.sh: --takes has '$take'; a take is global or rolling, a dash and milliseconds: global-20" >&2
    exit 2
  fi
done
start=10  # where a motion is entered [s]: the first seconds are often still

# render MOTION TAKE SCENE_SEED: TAKE is the shutter and the exposure [ms]
render() {
  local folder=$output/sequences/$1-$2 shutter=()
  if [ -d "$folder" ]; then return 0; fi
  if [[ $2 = rolling-* ]]; then shutter=(--row-time "$row_time"); fi
  "$bin/mba_vo_simulate" --motion "$motions/$1.txt" --start "$start" --scene-seed "$3" "${camera[@]}" "${shutter[@]}" \
    --exposure "$(awk -v ms="${2#*-}" 'BEGIN { print ms / 1000 }')" --depth --max-step 1 --no-cache --overwrite --output "$folder.part" >/dev/null
  mv "$folder.part" "$folder"  # whole, or not there
}

# export_folders MOTION-TAKE: in the forms of others, and the data sheet of its images
export_folders() {
  local sequence=$output/sequences/$1 folder=$output/export/$1 sheet=$output/datasheet/$1.csv
  if [ -s "$sheet" ]; then return 0; fi  # the last thing to be written
  "$bin/mba_vo_export" "$sequence" --depth depth --output "$folder" --overwrite >/dev/null
  if [ -x "$bin/mba_vo_make_bag" ]; then
    "$bin/mba_vo_make_bag" "$sequence" --depth depth --output "$folder/$1.bag" >/dev/null
  fi
  mkdir -p "$output/datasheet"
  { echo blur_px; cat "$sequence/blur_px.txt"; } | paste -d , "$folder/frames.csv" - >"$sheet.part"
  mv "$sheet.part" "$sheet"
}

# Of every sequence: quantiles of the blur, and means of the rest
write_datasheet() {
  echo "sequence,images,blur_median_px,blur_90_px,blur_largest_px,light,saturated,texture"
  local sheet
  for sheet in "$@"; do
    tail -n +2 "$sheet" | sort -t , -g -k 7 | awk -F , -v name="$(basename "$sheet" .csv)" '
      { light += $4; saturated += $5; texture += $6; blur[NR] = $7 }
      END { printf "%s,%d,%g,%g,%g,%.2f,%.5f,%.3f\n", name, NR, blur[int((NR + 1) / 2)], blur[int(0.9 * NR + 0.5)], blur[NR],
            light / NR, saturated / NR, texture / NR }'
  done
}

# entry MOTION TAKE: of the experiment file. A time of 0 means unknown in times.txt, so exposures of 0 are told
entry() {
  local options=""
  if [[ $2 = *-0 ]]; then options="--exposure 0"; fi
  if [[ $2 = rolling-* ]]; then options="$options --row-time $row_time"; fi
  echo "  $1-$2: {path: $1-$2, options: \"$options\", group: \"${2%-*} shutter, ${2#*-} ms\"}"
}

mkdir -p "$output/sequences"
index=0
for name in "${names[@]}"; do
  for take in "${takes[@]}"; do
    echo "rendering $name-$take"
    render "$name" "$take" $((seed + index))
    if $export; then export_folders "$name-$take"; fi
  done
  index=$((index + 1))
done
{
  printf 'title: Blur benchmark, rooms from seed %d\ndata: sequences\nstarts: [%s]\nsequences:\n' "$seed" "$starts"
  for name in "${names[@]}"; do
    for take in "${takes[@]}"; do entry "$name" "$take"; done
  done
  printf 'variants:\n  blur model: {}\n  no blur model: {options: --exposure 0}\n'
} >"$output/experiment.yaml"
if $export; then
  sheets=()
  for name in "${names[@]}"; do
    for take in "${takes[@]}"; do sheets+=("$output/datasheet/$name-$take.csv"); done
  done
  write_datasheet "${sheets[@]}" >"$output/datasheet.csv"
fi
if $render_only; then exit 0; fi
tools/mba_vo_benchmark "$output/experiment.yaml" --bin "$bin" --output "$output/results"
