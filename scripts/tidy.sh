#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tidy.sh [BUILD]: clang-tidy with .clang-tidy's checks over every room, a folder at a time, as BUILD (build/ci) compiles it. Exit 1 on a finding.
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
# Clang does not know some of GCC's options, and needs none that instruments. The folders are the files named Unity; a unit with options of its own
# stays alone.
python3 - "$build" build/tidy/compile_commands.json <<'PY'
import json, pathlib, re, sys
build = pathlib.Path(sys.argv[1]).resolve()
root = pathlib.Path.cwd()
kept = []
for entry in json.loads((build / "compile_commands.json").read_text()):
    file = pathlib.Path(entry["file"])
    if "/Unity/" in str(file) or (root in file.parents and file.relative_to(root).parts[0] not in ("tests", "bench", "build")):
        entry["command"] = re.sub(r" \S*(-fsanitize|-fno-sanitize|-fprofile|--coverage|-W)\S*", "", entry["command"])
        kept.append(entry)
pathlib.Path(sys.argv[2]).write_text(json.dumps(kept))
print("\n".join(entry["file"] for entry in kept), file=open("build/tidy/files", "w"))
PY
echo "clang-tidy: $(wc -l <build/tidy/files) files, with $tidy"
xargs -d '\n' -P "$(nproc)" -n 1 "$tidy" -p build/tidy --quiet <build/tidy/files 2>build/tidy/log || { tail -n 20 build/tidy/log >&2; exit 1; }
