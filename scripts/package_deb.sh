#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds swath and packs it for the Debian or Ubuntu that it is built on: out/packages/swath_VERSION_ARCHITECTURE.deb.
# SWATH_BUILD names a build that is there already. SOURCE_DATE_EPOCH dates the package; without it the last commit.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/package_build.sh
cpack --config "$build/CPackConfig.cmake" -G DEB -B "$build/deb" >"$build/cpack.log" || { cat "$build/cpack.log" >&2; exit 1; }
mkdir -p out/packages
mv "$build"/deb/*.deb out/packages/
ls -l out/packages/*.deb
