#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes build/gdal/lib/libgdal.so.N for the packages: the system's GDAL, of the same version, patches and binary interface, with the
# drivers alone that swath opens files with (io/vector/gdal_door.cpp). The system's own brings some 60 libraries of 110 MB: databases, web
# services, PDF. Its source is the distribution's; nothing is installed. About a quarter of an hour of one processor, once: a later call finds it.
set -euo pipefail
cd "$(dirname "$0")/.."
build="$PWD/build/gdal"
version="$(dpkg-query -W -f='${source:Version}' libgdal-dev)"
if [ "$(cat "$build/version" 2>/dev/null)" = "$version $(sha256sum <scripts/build_gdal.sh)" ]; then exit 0; fi
for tool in dpkg-source cmake ninja; do
  command -v "$tool" >/dev/null || { echo "swath: $tool is missing; apt-get install dpkg-dev cmake ninja-build" >&2; exit 1; }
done
rm -rf "$build"
mkdir -p "$build/lists/partial" "$build/sources"

# Source packages from where this system's packages come from, with lists of their own, so that the system's stay as they are.
for file in /etc/apt/sources.list.d/*.sources; do
  if [ -f "$file" ]; then sed 's/^Types:.*/Types: deb-src/' "$file" >"$build/sources/$(basename "$file")"; fi
done
for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
  if [ -f "$file" ]; then sed -n 's/^deb\(-src\)\? /deb-src /p' "$file" | sort -u >"$build/sources/$(basename "$file" .list).list"; fi
done
own=(-q -o "Dir::Etc::SourceList=/dev/null" -o "Dir::Etc::SourceParts=$build/sources" -o "Dir::State::Lists=$build/lists"
  -o "Dir::Cache::SrcPkgCache=" -o "Dir::Cache::PkgCache=")
echo "== GDAL $version: source"
apt-get "${own[@]}" update >"$build/source.log" 2>&1 || echo "swath: some lists of sources could not be fetched ($build/source.log)" >&2
(cd "$build" && apt-get "${own[@]}" --only-source --download-only source "gdal=$version" >>source.log 2>&1) || { tail -5 "$build/source.log" >&2; exit 1; }
dpkg-source --extract "$build"/gdal_*.dsc "$build/source" >/dev/null

echo "== GDAL $version: build"
drivers=()
for name in RAW AAIGRID GSG XYZ SRTMHGT USGSDEM DTED PNG JPEG; do drivers+=("-DGDAL_ENABLE_DRIVER_$name=ON"); done
for name in CSV DXF FLATGEOBUF KML SQLITE GPKG; do drivers+=("-DOGR_ENABLE_DRIVER_$name=ON"); done
libraries=()
for name in TIFF GEOTIFF PROJ SQLITE3 ZLIB DEFLATE ZSTD EXPAT JPEG PNG JSONC ICONV; do libraries+=("-DGDAL_USE_$name=ON"); done
cmake -S "$build/source" -B "$build/tree" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS="-ffile-prefix-map=$build=." \
  -DCMAKE_C_FLAGS="-ffile-prefix-map=$build=." -DGDAL_HIDE_INTERNAL_SYMBOLS=ON -DGDAL_USE_EXTERNAL_LIBS=OFF -DGDAL_USE_LERC_INTERNAL=ON \
  -DGDAL_USE_GIF_INTERNAL=OFF -DGDAL_USE_QHULL_INTERNAL=OFF -DGDAL_USE_OPENCAD_INTERNAL=OFF \
  -DGDAL_BUILD_OPTIONAL_DRIVERS=OFF -DOGR_BUILD_OPTIONAL_DRIVERS=OFF "${drivers[@]}" "${libraries[@]}" \
  -DBUILD_APPS=OFF -DBUILD_TESTING=OFF -DBUILD_PYTHON_BINDINGS=OFF -DBUILD_JAVA_BINDINGS=OFF -DBUILD_CSHARP_BINDINGS=OFF -DBUILD_DOCS=OFF \
  >"$build/configure.log" 2>&1 || { tail -20 "$build/configure.log" >&2; exit 1; }
cmake --build "$build/tree" --target GDAL >"$build/build.log" 2>&1 || { tail -20 "$build/build.log" >&2; exit 1; }

mkdir -p "$build/lib"
cp -P "$build"/tree/libgdal.so.* "$build/lib/"
strip --strip-unneeded "$build"/lib/libgdal.so.*.*
cp "$build/source/debian/copyright" "$build/copyright"
rm -rf "$build/tree" "$build/source" "$build/lists"
echo "$version $(sha256sum <scripts/build_gdal.sh)" >"$build/version"
ls -l "$build/lib"
