#!/usr/bin/env bash
# Installs the dependencies and builds everything into build/ and devel/.
#
#   scripts/build.sh [--no-install] [CMAKE OPTION...]
#
#   --no-install   the dependencies are there already
#
# MBA_VO_JOBS: compilers at a time (all cores).
set -euo pipefail
case "${1:-}" in -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;; esac
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [ "${1:-}" = --no-install ]; then
  shift
else
  scripts/install_dependencies.sh
fi
export CCACHE_SLOPPINESS=pch_defines,time_macros  # precompiled headers
if command -v ccache >/dev/null; then set -- -DCMAKE_CXX_COMPILER_LAUNCHER=ccache "$@"; fi
# Eight files at a time: half the compile time. Whoever changes one file again and again adds -DCMAKE_UNITY_BUILD=OFF.
cmake -S . -B build -DCMAKE_UNITY_BUILD=ON "$@"
cmake --build build -j "${MBA_VO_JOBS:-$(nproc)}"
