#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds swath and packs it for the Debian or Ubuntu that it is built on: out/packages/swath_VERSION_ARCHITECTURE.deb. It needs the system's libraries,
# but for GDAL: the small one of scripts/build_gdal.sh lies in lib/swath of the package. SWATH_SYSTEM_GDAL=1 leaves it out and needs the system's.
# SWATH_BUILD names a build that is there already. SOURCE_DATE_EPOCH dates the package; without it the last commit.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/package_build.sh
own=()
rm -rf "$build/deb" "$build/deb_own"
if [ -z "${SWATH_SYSTEM_GDAL:-}" ]; then
  grep -q 'lib/swath' "$build/tools/cmake_install.cmake" ||
    { echo "swath: $build was made before the program looked into lib/swath; run cmake and build it again" >&2; exit 1; }
  bash scripts/build_gdal.sh
  mkdir -p "$build/deb_own/lib/swath" "$build/deb_own/share/doc/swath/licences"
  cp -L build/gdal/lib/libgdal.so.?? "$build/deb_own/lib/swath/"
  cp build/gdal/copyright "$build/deb_own/share/doc/swath/licences/libgdal"
  needed="$(sed -n 's/^set(CPACK_DEBIAN_PACKAGE_DEPENDS "\(.*\)")/\1/p' "$build/CPackConfig.cmake" | sed 's/libgdal[^,]*, //')"
  own=(-D "CPACK_INSTALLED_DIRECTORIES=$build/deb_own;usr" -D "CPACK_DEBIAN_PACKAGE_DEPENDS=$needed")
fi
cpack --config "$build/CPackConfig.cmake" -G DEB "${own[@]}" -B "$build/deb" >"$build/cpack.log" || { cat "$build/cpack.log" >&2; exit 1; }
mkdir -p out/packages
mv "$build"/deb/*.deb out/packages/
ls -l out/packages/*.deb
