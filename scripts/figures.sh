# shellcheck shell=bash
# Sourced by accuracy.sh, simulated.sh, motions.sh, distortion.sh and live.sh: runs mba_vo offline and prints one line of figures per
# run, those of what was published first. Uses $bin, the folder of the programs, and $output, the folder for trajectories
# and plots.

: "${bin:?}" "${output:?}"

# figure FILE PATH [KEY]: a number of a YAML file, PATH with dots; KEY within {braces}
figure() {
  awk -v path="$2" -v key="${3:-}" '
    match($0, /^ *[^ :]+:/) {
      depth = (match($0, /[^ ]/) - 1) / 2
      name = $1
      sub(/:$/, "", name)
      names[depth] = name
      here = names[0]
      for (i = 1; i <= depth; ++i) here = here "." names[i]
      if (here != path) next
      value = $0
      if (key == "") sub(/^[^:]*: */, "", value)
      else if (match(value, "[{ ]" key ": *")) value = substr(value, RSTART + RLENGTH)
      print 0 + value
      exit
    }' "$1"
}

print_header() {
  printf '%-20s | %9s %9s %8s %8s %8s %8s | %9s %9s %7s %7s %8s %4s | %8s %6s %5s\n' run 'map ATE' 'odom ATE' 'in time' \
    'moving' 'first[s]' 'p95[ms]' 'smoothed' 'rot[deg]' 'tracked' 'dropped' 'restarts' 'maps' 'track ms' 'map ms' MB
}

# print_run NAME FOLDER: figures of a run that has been evaluated (evaluation.yaml, and summary.yaml if it was offline);
# ATE in m; passes over the data before the one that counts, and maps that were begun; shares of images with a pose within a frame interval, of all and of those after the first parallax, in %
print_run() {
  local e=$2/evaluation.yaml s=$2/summary.yaml
  printf '%-20s | %9.5f %9.5f %7.1f%% %7.1f%% %8.2f %8.1f | %9.5f %9.3f %6.1f%% %7d %8d %4d | ' "$1" \
    "$(figure "$e" causal.map.ate rmse)" "$(figure "$e" causal.odometry.ate rmse)" \
    "$(figure "$e" causal.availability.pose_in_time percent)" \
    "$(figure "$e" causal.availability.pose_in_time_moving percent)" \
    "$(figure "$e" causal.availability.first_pose_after_parallax)" \
    "$(figure "$e" causal.availability.latency_ms percentile_95)" "$(figure "$e" smoothed.ate rmse)" \
    "$(figure "$e" smoothed.rotation rmse)" "$(awk -v d="$(figure "$e" smoothed.dropped_percent)" 'BEGIN { print 100 - d }')" \
    "$(figure "$e" smoothed.dropped_after_initialization)" "$(figure "$e" causal.restarts)" "$(figure "$e" causal.map.maps)"
  if [ -s "$s" ]; then
    printf '%8.1f %6.1f %5.0f\n' "$(figure "$s" times.tracking per_frame_ms)" "$(figure "$s" times.mapping per_frame_ms)" \
      "$(figure "$s" peak_memory_mb)"
  else
    echo
  fi
}

# evaluate SEQUENCE FOLDER: compares the run in FOLDER with the truth of the sequence; evaluation.yaml and a plot
evaluate() {
  "$bin/mba_vo_evaluate" --groundtruth "$1/groundtruth.txt" --run "$2" --yaml "$2/evaluation.yaml" --plot "$2/trajectory.png"
}

# run_and_print NAME SEQUENCE OPTION...: options of mba_vo_offline
run_and_print() {
  local run=$1 sequence=$2 folder=$output/$1
  shift 2
  mkdir -p "$folder"
  rm -f "$folder"/*
  if ! "$bin/mba_vo_offline" "$sequence" --output "$folder" --deterministic "$@" >"$folder/log.txt" 2>&1 ||
    ! evaluate "$sequence" "$folder" >>"$folder/log.txt" 2>&1; then
    printf '%-20s failed: %s\n' "$run" "$(tail -n 1 "$folder/log.txt")"
    return 0
  fi
  print_run "$run" "$folder"
}

# median NUMBER...
median() { printf '%s\n' "$@" | sort -g | sed -n "$((($# + 1) / 2))p"; }

# largest NUMBER...
largest() { printf '%s\n' "$@" | sort -g | tail -n 1; }

# print_median NAME RUN...: of these runs, ATE as published and smoothed, and the most restarts and maps that one of them
# had; one start says little, the figures scatter by half
print_median() {
  local name=$1 run
  local online=() moving=() smoothed=() restarts=() maps=()
  shift
  for run in "$@"; do
    online+=("$(figure "$output/$run/evaluation.yaml" causal.map.ate rmse)")
    moving+=("$(figure "$output/$run/evaluation.yaml" causal.availability.pose_in_time_moving percent)")
    smoothed+=("$(figure "$output/$run/evaluation.yaml" smoothed.ate rmse)")
    restarts+=("$(figure "$output/$run/evaluation.yaml" causal.restarts)")
    maps+=("$(figure "$output/$run/evaluation.yaml" causal.map.maps)")
  done
  printf 'median of %-10s | %9.5f %26s%% %18s | %9.5f %26s %8d %4d\n' "$name" "$(median "${online[@]}")" "$(median "${moving[@]}")" '' \
    "$(median "${smoothed[@]}")" '' "$(largest "${restarts[@]}")" "$(largest "${maps[@]}")"
}

# run_starts NAME SEQUENCE [OPTION...]: as live, without so many of the first images as each of $starts says
run_starts() {
  local name=$1 sequence=$2 start runs=()
  shift 2
  # shellcheck disable=SC2154  # of the script
  for start in "${starts[@]}"; do
    runs+=("$name-$start")
    run_and_print "${runs[-1]}" "$sequence" --live --skip "$start" "$@"
  done
  if [ ${#runs[@]} -gt 1 ]; then print_median "$name" "${runs[@]}"; fi
}
