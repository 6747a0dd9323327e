# shellcheck shell=bash
# Sourced by accuracy.sh and distortion.sh: runs mba_vo offline and prints one line of figures per run. Uses $bin, the
# folder of the programs, and $output, the folder for trajectories and plots.

: "${bin:?}" "${output:?}"

# figure FILE REGEXP: the number that follows REGEXP in a YAML file
figure() {
  awk -v regexp="$2 *" 'match($0, regexp) { print 0 + substr($0, RSTART + RLENGTH); exit }' "$1"
}

print_header() {
  printf '%-20s %9s %9s %7s %9s %7s %9s %9s %7s\n' run 'ATE [m]' 'rot [deg]' scale tracked dropped 'track ms' 'map ms' MB
}

# run_and_print NAME SEQUENCE OPTION...: options of mba_vo_offline
run_and_print() {
  local run=$1 sequence=$2 folder=$output/$1
  shift 2
  mkdir -p "$folder"
  rm -f "$folder"/*
  if ! "$bin/mba_vo_offline" "$sequence" --output "$folder" --deterministic "$@" >"$folder/log.txt" 2>&1 ||
    ! "$bin/mba_vo_evaluate" --groundtruth "$sequence/groundtruth.txt" --estimate "$folder/trajectory.txt" \
      --frames "$folder/frames.csv" --yaml "$folder/evaluation.yaml" --plot "$folder/trajectory.png" \
      >>"$folder/log.txt" 2>&1; then
    printf '%-20s failed: %s\n' "$run" "$(tail -n 1 "$folder/log.txt")"
    return 0
  fi
  local result=$folder/evaluation.yaml summary=$folder/summary.yaml
  printf '%-20s %9.5f %9.3f %7.3f %8.1f%% %7d %9.1f %9.1f %7.0f\n' "$run" \
    "$(figure "$result" '^ate: {rmse:')" "$(figure "$result" '^rotation: {rmse:')" "$(figure "$result" '^scale:')" \
    "$(awk '/^dropped_percent:/ { print 100 - $2 }' "$result")" "$(figure "$result" '^dropped_after_initialization:')" \
    "$(figure "$summary" 'tracking:.*per_frame_ms:')" "$(figure "$summary" 'mapping:.*per_frame_ms:')" \
    "$(figure "$summary" '^peak_memory_mb:')"
}

# print_median NAME RUN...: of the ATE of these runs; one start says little, the figures scatter by half
print_median() {
  local name=$1
  shift
  printf 'median of %-10s %9.5f\n' "$name" "$(for run in "$@"; do
    figure "$output/$run/evaluation.yaml" '^ate: {rmse:'
  done | sort -g | sed -n "$((($# + 1) / 2))p")"
}
