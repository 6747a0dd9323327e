#!/usr/bin/env bash
# Builds everything and runs all tests: unit tests, end-to-end tests, and tests of the nodes with their own ROS master.
#
#   scripts/test.sh [--no-install]      --no-install: the dependencies are there already
set -euo pipefail
case "${1:-}" in -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;; esac
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/build.sh "$@" -DMBA_VO_TESTS=ON
ctest --test-dir build --output-on-failure -j "$(nproc)"
