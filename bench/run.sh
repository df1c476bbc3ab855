#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Whole process, time and peak memory as the OS reports them: bench/run.sh SWATH CONFIG SURVEY [OPTION ...]
# Needs /usr/bin/time (Debian package time). Runs three times into a folder that it removes.
set -euo pipefail
swath=$1 config=$2 survey=$3
shift 3
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
for round in 1 2 3; do
  rm -rf "$out/products"
  /usr/bin/time -f "wall %e s   cpu %U + %S s   peak %M kB" "$swath" run "$config" --survey "$survey" --output "$out/products" --quiet "$@"
done
python3 - "$out/products/report.json" <<'P'
import json, sys
report = json.load(open(sys.argv[1]))
returns = max(s["counts"]["in"] for s in report["stages"] if "counts" in s)
print(f"{returns} returns, {returns / report['seconds'] / 1e6:.2f} M returns/s in the last round")
for s in report["stages"]:
    print(f"  {s['type']:20} {s['seconds']:8.2f} s")
P
