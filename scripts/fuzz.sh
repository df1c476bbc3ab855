#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# fuzz.sh [SECONDS [TARGET...]]: builds the fuzz targets of tests/fuzz and runs each for SECONDS (60), as many at a time as there are
# processors (FUZZ_JOBS; FUZZ_SEED: of the mutations; FUZZ_RUNS: most executions). One line per target; exit 1 on any finding, whose input lies in build/fuzz/findings. What covers new code is
# kept in build/fuzz/corpus, and the next run starts from it.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds="${1:-60}"
shift || true

# --- clang 16 or newer with libFuzzer: an older one does not take the ranges of GCC 12's library
find_clang() {
  local one version
  for one in ${CXX:-} clang++ clang++-20 clang++-19 clang++-18 clang++-17 clang++-16; do
    command -v "$one" >/dev/null || continue
    version="$("$one" -dumpversion 2>/dev/null | sed 's/\..*//')"
    [ "${version:-0}" -ge 16 ] 2>/dev/null || continue
    echo 'extern "C" int LLVMFuzzerTestOneInput(const char*, unsigned long) { return 0; }' |
      "$one" -x c++ - -fsanitize=fuzzer,address,undefined -o /dev/null 2>/dev/null && { echo "$one"; return 0; }
  done
  return 1
}
if ! clang="$(find_clang)"; then
  version=16
  grep -q '^VERSION_CODENAME=noble' /etc/os-release && version=18
  as_root=()
  [ "$(id -u)" -eq 0 ] || as_root=(sudo -n)
  echo "installing: clang-$version libclang-rt-$version-dev"
  installed="$({ "${as_root[@]}" apt-get update -q && "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y \
      --no-install-recommends "clang-$version" "libclang-rt-$version-dev"; } 2>&1)" || true
  if ! clang="$(find_clang)"; then
    echo "fuzz: SKIPPED, nothing was fuzzed: clang 16 or newer with libFuzzer is not here and cannot be installed" >&2
    tail -n 5 <<<"$installed" >&2
    exit 3
  fi
fi

# --- build: core, io and the targets alone
cmake --preset fuzz -DCMAKE_CXX_COMPILER="$clang" >/dev/null 2>&1 || { echo "fuzz: cmake fails: cmake --preset fuzz -DCMAKE_CXX_COMPILER=$clang" >&2; exit 1; }
cmake --build build/fuzz >build/fuzz/build.log 2>&1 || { tail -n 40 build/fuzz/build.log; exit 1; }
programs=build/fuzz/tests/fuzz
corpus=build/fuzz/corpus
findings=build/fuzz/findings
logs=build/fuzz/logs
seeds=build/fuzz/seeds
rm -rf "$seeds"
mkdir -p "$seeds" "$findings" "$logs"
"$programs/fuzz_seeds" "$seeds"
cp -r tests/fuzz/seeds/. "$seeds"
mkdir "$seeds/info"
for file in "$seeds"/*/*; do
  case "$file" in "$seeds"/info/*) ;; *) cp "$file" "$seeds/info/$(basename "$(dirname "$file")")-$(basename "$file")" ;; esac
done

# --- run
# Inputs of 16 KiB suffice but for a GeoPackage: every other format's headers and records are small. The first limit is the hang, the other two the memory: a
# reader takes what its file and its batches need, and the sanitizer two to three times that.
run_target() {
  local target="$1" log="$logs/$1.log" status=0 longest=16384
  [ "$target" = vector ] && longest=160000
  mkdir -p "$corpus/$target"
  nice "$programs/fuzz_$target" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=1024 -malloc_limit_mb=256 -max_len="$longest" \
    -print_final_stats=1 -seed="${FUZZ_SEED:-0}" -runs="${FUZZ_RUNS:--1}" -artifact_prefix="$findings/$target-" "$corpus/$target" "$seeds/$target" >"$log" 2>&1 || status=$?
  local executions coverage
  executions="$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")"
  coverage="$(grep -o 'cov: [0-9]*' "$log" | tail -n 1 | cut -d' ' -f2)"
  if [ "$status" -eq 0 ]; then
    printf '%-8s %9s executions  coverage %6s  no findings\n' "$target" "${executions:-?}" "${coverage:-?}"
  else
    printf '%-8s %9s executions  coverage %6s  FINDING: %s\n' "$target" "${executions:-?}" "${coverage:-?}" \
      "$(grep -m 1 -E '^(finding:|SUMMARY:|==[0-9]+== ?ERROR|==[0-9]+==ERROR)|terminate called|what\(\)' "$log" || echo "exit $status")"
    grep -m 1 'Test unit written to' "$log" || true
    return 1
  fi
}
export UBSAN_OPTIONS="print_stacktrace=1${UBSAN_OPTIONS:+:$UBSAN_OPTIONS}"
# freed blocks that the sanitizer keeps back count as memory: its 256 MB would come before any growth of the reader's own
export ASAN_OPTIONS="quarantine_size_mb=32${ASAN_OPTIONS:+:$ASAN_OPTIONS}"
export -f run_target
export programs corpus findings logs seeds seconds

targets=("$@")
if [ "${#targets[@]}" -eq 0 ]; then
  for program in "$programs"/fuzz_*; do
    name="$(basename "$program")"
    [ "$name" = fuzz_seeds ] || { [ -x "$program" ] && [ -f "$program" ] && targets+=("${name#fuzz_}"); }
  done
fi
rm -f build/fuzz/found
echo "fuzzing ${#targets[@]} targets, ${seconds} s each, with $clang"
printf '%s\n' "${targets[@]}" | xargs -P "${FUZZ_JOBS:-$(nproc)}" -I{} bash -c 'run_target {} || touch build/fuzz/found' || true
# A target that crashed leaves its folder.
for left in /dev/shm/swath-fuzz-*; do
  [ ! -d "$left" ] || [ -d "/proc/${left##*-}" ] || rm -rf "$left"
done
if [ -e build/fuzz/found ]; then
  rm build/fuzz/found
  echo "fuzz: findings; again by: $programs/fuzz_TARGET FILE" >&2
  exit 1
fi
