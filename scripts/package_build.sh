# SPDX-License-Identifier: GPL-3.0-or-later
# Read by the scripts that pack: sets `build`, a release build, and SOURCE_DATE_EPOCH.
if [ -z "${SOURCE_DATE_EPOCH:-}" ]; then
  SOURCE_DATE_EPOCH="$(git log -1 --format=%ct 2>/dev/null || date +%s)"
fi
export SOURCE_DATE_EPOCH
umask 022
build="${SWATH_BUILD:-}"
if [ -z "$build" ]; then
  build=build/package
  bash scripts/install.sh
  cmake --preset release -B "$build" -DSWATH_TESTS=OFF -DSWATH_PAGES=ON
  cmake --build "$build"
fi
build="$(realpath "$build")"
