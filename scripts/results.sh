#!/usr/bin/env bash
# Makes docs/results.md: renders sequences, runs mba_vo_benchmark over them, with the blur model and without it, and writes
# down what was published, what was known in the end, times and memory.
#
#   scripts/results.sh [--quick] [--data DIR] [--motions DIR] [--output DIR] [--page FILE] [--jobs N] [--bin DIR]
#
#   --quick         two small sequences, one start: 3 minutes instead of 30, on two cores
#   --data DIR      also the sequences found there: folders with images and groundtruth.txt (docs/offline.md)
#   --motions DIR   also rooms rendered around recorded motions, t tx ty tz qx qy qz qw: hand_desk, head_room6 and drone_v202
#   --output DIR    folder for sequences and runs (output/results); what is found there is used again
#   --page FILE     the page to write (docs/results.md; with --quick DIR/results.md)
#   --jobs N        runs side by side, and threads that render (all cores)
#   --bin DIR       folder of the programs (devel/lib/mba_vo)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

quick=false
data=
motions=
output=output/results
page=
jobs=$(nproc)
bin=devel/lib/mba_vo
told=scripts/results.sh  # the command as the page tells it: what the figures depend on
while [ $# -gt 0 ]; do
  case "$1" in
    --quick) quick=true; told+=" --quick" ;;
    --data) data=${2:?--data needs a folder}; told+=" --data $data"; shift ;;
    --motions) motions=${2:?--motions needs a folder}; told+=" --motions $motions"; shift ;;
    --output) output=${2:?--output needs a folder}; shift ;;
    --page) page=${2:?--page needs a file}; shift ;;
    --jobs) jobs=${2:?--jobs needs a number}; shift ;;
    --bin) bin=${2:?--bin needs a folder}; shift ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) echo "results.sh: '$1' is no option; see --help" >&2; exit 2 ;;
  esac
  shift
done
for folder in "$data" "$motions"; do
  if [ -n "$folder" ] && [ ! -d "$folder" ]; then echo "results.sh: $folder: no such folder" >&2; exit 1; fi
done

small=(--width 376 --height 240 --fx 215)
row_time=0.0001  # 240 rows in 24 ms [s]
blurred=
sharp=
: "${page:=$($quick && echo "$output/results.md" || echo docs/results.md)}"
mkdir -p "$output/sequences"
: >"$output/sequences.txt"
cut -d " " -f 1 /proc/loadavg >"$output/load.txt"  # of other programs: nothing of ours runs yet

# entry NAME FOLDER OPTIONS WHAT: a sequence, and its sharp images if there are any
entry() {
  printf '%s\t%s\n' "$1" "$4" >>"$output/sequences.txt"
  blurred+="  $1: {path: \"$2\", options: \"$3\"}"$'\n'
  if [ -d "$2/images_sharp" ]; then sharp+="  $1: {path: \"$2\", options: --images images_sharp --exposure 0}"$'\n'; fi
}

# render NAME SECONDS OPTIONS WHAT OPTION...: OPTIONS for the odometry, OPTION... for the renderer. Half a pixel between two sub-frames is
# only needed where rendering itself is judged.
render() {
  local name=$1 seconds=$2 options=$3 what=$4 folder
  shift 4
  folder=$(realpath "$output/sequences")/$name-$seconds
  if [ ! -s "$folder/blur_px.txt" ]; then  # the last thing to be written
    echo "rendering $name"
    "$bin/mba_vo_simulate" --duration "$seconds" --max-step 1 --threads "$jobs" --no-cache --overwrite --output "$folder" "$@" >/dev/null
  fi
  entry "$name" "$folder" "$options" "$what"
}

if $quick; then
  starts=0
  render room-61s 5 "" "hand-held in a room, exposure 20 ms" --scene-seed 61 --trajectory-seed 61 "${small[@]}" --sharp
  render rolling-64 5 "--row-time $row_time" "rolling shutter of 24 ms, told" \
    --scene-seed 64 --trajectory-seed 64 "${small[@]}" --row-time "$row_time"
else
  starts="0, 10, 20"
  for seed in 61 62 63; do
    render "room-$seed" 10 "" "hand-held in a room, exposure 20 ms" --scene-seed "$seed" --trajectory-seed "$seed" --sharp
  done
  render rolling-64 10 "--row-time $row_time" "rolling shutter of 24 ms, told" \
    --scene-seed 64 --trajectory-seed 64 "${small[@]}" --row-time "$row_time"
  render webcam-65 10 "" "nothing told: rolling shutter, exposure 6-24 ms, gamma 2.2, dark corners, focal length 1 % wrong, JPEG" \
    --scene-seed 65 --trajectory-seed 65 "${small[@]}" --row-time "$row_time" --exposure-min 0.006 --exposure-max 0.024 --hide-exposure \
    --gamma 2.2 --vignette 0.35 --calibration-focal-error 0.01 --jpeg 92 --auto-gain --gain-error 0.15
fi
if [ -n "$motions" ]; then
  for motion in "$motions"/{hand_desk,head_room6,drone_v202}.txt; do
    if [ ! -s "$motion" ]; then continue; fi
    render "$(basename "$motion" .txt)" "$($quick && echo 5 || echo 10)" "" "recorded motion, room rendered around it, exposure 20 ms" \
      --motion "$motion" --start 10 --scene-seed 66 "${small[@]}"
  done
fi
if [ -n "$data" ]; then
  for truth in "$data"/*/groundtruth.txt; do
    folder=$(realpath "$(dirname "$truth")")
    entry "$(basename "$folder")" "$folder" "" "found in --data"
  done
fi

# benchmark NAME SEQUENCES VARIANTS: runs that are there already are not made again
benchmark() {
  if [ -z "$2" ]; then return 0; fi
  printf 'title: %s\nstarts: [%s]\nsequences:\n%svariants:\n%s' "$1" "$starts" "$2" "$3" >"$output/$1.yaml"
  tools/mba_vo_benchmark "$output/$1.yaml" --bin "$bin" --output "$output/$1" --jobs "$jobs"
}
benchmark blurred "$blurred" $'  live: {options: --live}\n  each-image: {}\n  no-blur-model: {options: --live --exposure 0}\n'
benchmark sharp "$sharp" $'  live: {options: --live}\n'
rm -f "$output/memory.txt"
if ! $quick; then
  echo "four minutes to and fro, for the growth of the memory"
  scripts/memory.py --bin "$bin" --minutes 4 "$output/sequences/room-61-10" >"$output/memory.txt"
fi
/usr/bin/python3 scripts/results_page.py "$output" --command "$told" --jobs "$jobs" >"$output/page.part"
mv "$output/page.part" "$page"
echo "$page"
