#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tidy.sh [BUILD]: clang-tidy with .clang-tidy's checks over every room, a folder at a time, as BUILD (build/ci) compiles it. Exit 1 on a finding.
# What had none is not looked at again until it changes: see tidy.py.
set -euo pipefail
cd "$(dirname "$0")/.."
build="${1:-build/ci}"
[ -f "$build/compile_commands.json" ] || { echo "tidy: $build is not configured: cmake --preset ci" >&2; exit 1; }
# 16 or newer: an older one does not take the ranges of GCC 12's library.
find_tidy() {
  for one in clang-tidy-16 clang-tidy-18 clang-tidy-17; do
    if command -v "$one" >/dev/null; then echo "$one"; return; fi
  done
}
tidy="$(find_tidy)"
if [ -z "$tidy" ]; then
  version=16
  grep -q '^VERSION_CODENAME=noble' /etc/os-release && version=18
  as_root=()
  [ "$(id -u)" -eq 0 ] || as_root=(sudo -n)
  echo "installing: clang-tidy-$version"
  { "${as_root[@]}" apt-get update -q && "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y \
      --no-install-recommends "clang-tidy-$version"; } >/dev/null 2>&1 || true
  tidy="$(find_tidy)"
  [ -n "$tidy" ] || { echo "tidy: SKIPPED, nothing was looked at: clang-tidy 16 or newer is not here and cannot be installed" >&2; exit 3; }
fi
mkdir -p build/tidy
python3 scripts/tidy.py "$build" "$tidy" "$(nproc)"
