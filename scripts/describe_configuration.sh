#!/usr/bin/env bash
# Writes the tables of options in docs/configuration.md anew: those for users, listed here with the symptom for which to
# change them, and all, from config/default.yaml, which a test keeps equal to the code. --check: only says whether the page
# is up to date.
set -euo pipefail
case "${1:-}" in -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;; esac
cd "$(dirname "${BASH_SOURCE[0]}")/.."

page=docs/configuration.md
mark='<!-- options: scripts/describe_configuration.sh -->'

# option: when to change it
# shellcheck disable=SC2016  # backticks of Markdown
for_users='
image.binning: 2, on a machine that is known to be slow; 1, where images are large and every tenth of a millimetre counts
image.gamma: the camera cannot be set to linear light; `mba_vo_check` names a gamma
image.response_file: the response is calibrated; counts instead of the gamma
image.vignette_file: the vignette is calibrated; without, dark corners are found with the first map
image.mask_file: the vehicle or a text covers a part of the image; without, it is found after some seconds of motion
image.white_level: 16-bit images whose highest value is none of those
image.row_time: the shutter rolls, the first map is long in coming or bent; without, it is found after a while
image.learnt_file: a camera is used again, and each start warns of the same corrections
tracker.unknown_exposure: the exposure is unknown, and the camera hardly moves before the map: else its first frames tell
tracker.estimate_exposure: off, where exposures are right for sure and are called wrong all the same
tracker.max_points: downwards, where tracking takes longer than a frame interval: latency grows, images are dropped
tracker.degraded_pixel_error: upwards, where good poses are `DEGRADED` all the time, as with an approximate calibration
tracker.degraded_expected_error: downwards, where a filter suffers from poses that few points tell
keyframe.flow_px: upwards, where the mapper falls behind; downwards, where the camera is lost between keyframes
mapper.initializer.min_parallax: downwards, where the status says "only rotation so far" although the camera moves, but far from everything
mapper.initializer.buffer_seconds: upwards, where the camera moves so slowly that there is no parallax within it
mapper.depth_sensor.max_depth: depth images that are wrong far away, or right beyond it
mapper.window.max_points: upwards, where there is time to spare; downwards, where new keyframes come late all the time
mapper.window.max_residuals: the same
mapper.deblur.method: sharp images of keyframes are wanted; the map seldom needs them
mapper.restart_after_lost: upwards, where the camera is likely to come back to what it knows
mapper.relocalizer.max_keyframes: upwards, where it comes back after long; downwards, to save memory (0.4 MB each)
mapper.loops.close: on, where the camera comes back to places: map and trajectory no longer drift there
mapper.loops.max_megabytes: upwards, for large places; downwards, to save memory
mapper.refine_calibration: off, where the calibration is exact and is corrected all the same
'

# tables WHICH: of the options for users ("users"), or of all ("all"), whose meanings may speak of those before them
tables() {
  awk -v which="$1" '
    function name(depth, key,   i, path) { for (i = 0; i < depth; ++i) path = path section[i] "."; return path key }
    FNR == NR {  # the list
      if (match($0, /: /)) { option = substr($0, 1, RSTART - 1); symptom[option] = substr($0, RSTART + 2); order[++count] = option }
      next
    }
    {
      match($0, /^ */); depth = RLENGTH / 2
      key = substr($0, RLENGTH + 1); sub(/:.*/, "", key)
      if ($0 ~ /:$/) {
        section[depth] = key
        if (depth == 0 && which == "all") printf "\n### %s\n\n| option | default | range | meaning |\n|---|---|---|---|\n", key
        next
      }
      value = $0; sub(/^[^:]*: /, "", value)
      meaning = value; sub(/ +#.*/, "", value); sub(/^[^#]*# /, "", meaning)
      range = ""
      if (match(meaning, / \([-+.0-9e]+ to [-+.0-9e]+\)$/)) {
        range = substr(meaning, RSTART + 2, RLENGTH - 3); meaning = substr(meaning, 1, RSTART - 1)
      }
      option = name(depth, key)
      if (option in symptom) line[option] = sprintf("| `%s` | `%s` | %s | %s | %s |", option, value, range, meaning, symptom[option])
      if (which == "all") printf "| `%s` | `%s` | %s | %s |\n", option, value, range, meaning
    }
    END {
      for (i = 1; i <= count; ++i) {
        if (!(order[i] in line)) { print "describe_configuration.sh: " order[i] ": no option of config/default.yaml" >"/dev/stderr"; exit 1 }
        if (which == "users") print line[order[i]]
      }
    }' <(printf '%s' "$for_users") config/default.yaml
}

described() {
  sed "\|^$mark\$|q" "$page"
  printf '\n## Options for users\n\n| option | default | range | what it does | when to change it |\n|---|---|---|---|---|\n'
  tables users
  printf '\n## All options, for experts\n\nTheir defaults were found by measuring ([decisions](decisions/README.md)).\n'
  tables all
}

updated=$(described)
if [ "${1:-}" = --check ]; then
  diff -u "$page" <(printf '%s\n' "$updated") || { echo "$page is out of date: run scripts/describe_configuration.sh" >&2; exit 1; }
else
  printf '%s\n' "$updated" >"$page"
fi
