#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Are the crates of io/laz/Cargo.lock known to be unsafe? First the RustSec advisories, by cargo-audit where it is installed and can fetch
# them; then, by cargo alone, whether a locked version was withdrawn (yanked) by its authors. Exit 1 where one is, 3 where it cannot be asked.
set -euo pipefail
cd "$(dirname "$0")/.."
lock="${1:-io/laz/Cargo.lock}"
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
faults=0

if ! cargo audit --version >/dev/null 2>&1; then
  echo "advisories: NOT CHECKED, cargo-audit is not installed (cargo install cargo-audit)"
elif cargo audit --file "$lock" >"$scratch/audit" 2>&1; then
  echo "advisories: none for the crates of $lock"
elif grep -qiE "couldn't fetch|failed to fetch|git operation failed|io error|network|resolve" "$scratch/audit" && ! grep -q '^ID:' "$scratch/audit"; then
  echo "advisories: NOT CHECKED, the RustSec database cannot be fetched"
else
  cat "$scratch/audit"
  faults=1
fi

# A resolver never picks a withdrawn version: each locked one is asked for by its exact number, without the lock file.
mkdir "$scratch/src"
touch "$scratch/src/lib.rs"
printf '[package]\nname = "locked"\nversion = "0.0.0"\nedition = "2021"\n[dependencies]\n' >"$scratch/Cargo.toml"
crates="$(awk '/^name = /{gsub(/"/, "", $3); name = $3} /^version = /{gsub(/"/, "", $3); version = $3} /^source = /{print name, version}' "$lock")"
number=0
while read -r name version; do
  number=$((number + 1))
  printf 'c%d = { package = "%s", version = "=%s" }\n' "$number" "$name" "$version" >>"$scratch/Cargo.toml"
done <<<"$crates"
if cargo generate-lockfile --quiet --manifest-path "$scratch/Cargo.toml" 2>"$scratch/resolver"; then
  echo "withdrawn: none of $number crates"
elif grep -q 'yanked' "$scratch/resolver"; then
  echo "withdrawn:"
  sed 's/^/  /' "$scratch/resolver"
  faults=1
else
  echo "withdrawn: NOT CHECKED, the crates' registry does not answer"
  sed 's/^/  /' "$scratch/resolver"
  [ "$faults" -ne 0 ] || exit 3
fi
exit "$faults"
