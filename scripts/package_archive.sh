#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds swath and packs it with its libraries, data and typeface, to be unpacked anywhere by anyone: out/packages/swath-VERSION-linux-ARCHITECTURE
# .tar.zst and .zip. Only the C library is the system's, of the age of the one that it is built on or newer.
# SWATH_BUILD names a build that is there already. SOURCE_DATE_EPOCH dates the files; without it the last commit.
set -euo pipefail
cd "$(dirname "$0")/.."
for tool in patchelf zstd zip; do
  command -v "$tool" >/dev/null || { echo "swath: $tool is missing; apt-get install patchelf zstd zip" >&2; exit 1; }
done
source scripts/package_build.sh
bash scripts/build_gdal.sh

version="$(sed -n 's/^project(swath VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)"
name="swath-$version-linux-$(uname -m)"
stage="$build/archive"
root="$stage/$name"
rm -rf "$stage"
mkdir -p "$root"
cmake --install "$build" --prefix "$root" --strip >/dev/null
program="$root/bin/swath"

# The libraries that the loader finds for the program and for those that it loads at their first use, but for the C library's own. GDAL is the
# small one of scripts/build_gdal.sh.
mkdir -p "$root/lib"
small="$PWD/build/gdal/lib"
late="$(readelf -p .note.dlopen "$program" 2>/dev/null | sed -n 's/.*"soname":\["\([^"]*\)"\].*/\1/p')"
needed() { LD_LIBRARY_PATH="$small" ldd "$1" | sed -n 's/^[[:space:]]*[^ ]* => \(\/[^ ]*\) .*/\1/p'; }
{
  needed "$program"
  for soname in $late; do
    file="$small/$soname"
    [ -e "$file" ] || file="$(/sbin/ldconfig -p | sed -n "s/^[[:space:]]*$soname .* => //p" | head -1)"
    echo "$file"
    needed "$file"
  done
} | sort -u | while read -r file; do
  case "$(basename "$file")" in
    ld-linux* | libc.so* | libm.so* | libpthread.so* | libdl.so* | librt.so* | libresolv.so* | libutil.so* | libnsl.so*) continue ;;
  esac
  cp -L "$file" "$root/lib/"
done
chmod 755 "$root"/lib/*
patchelf --set-rpath '$ORIGIN/../lib' "$program"
for file in "$root"/lib/*; do patchelf --set-rpath '$ORIGIN' "$file"; done

# PROJ looks for share/proj beside the folder of its library.
mkdir -p "$root/share/proj" "$root/share/swath/fonts"
cp -L /usr/share/proj/proj.db /usr/share/proj/proj.ini "$root/share/proj/"
cp -L /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf /usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf "$root/share/swath/fonts/"
cp cmake/fonts.conf "$root/share/swath/fonts/"
# The licences of what is bundled.
mkdir -p "$root/share/doc/swath/licences"
for file in "$root"/lib/*; do
  dpkg-query -S "*/$(basename "$file")" 2>/dev/null | sed 's/:.*//' | sort -u
done | sort -u | while read -r package; do
  if [ -f "/usr/share/doc/$package/copyright" ]; then cp -L "/usr/share/doc/$package/copyright" "$root/share/doc/swath/licences/$package"; fi
done

find "$root" -exec touch -h -d "@$SOURCE_DATE_EPOCH" {} +
mkdir -p out/packages
tar -C "$stage" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" -cf - "$name" |
  zstd -q -19 -T1 -f -o "out/packages/$name.tar.zst"
rm -f "out/packages/$name.zip"
(cd "$stage" && find "$name" | LC_ALL=C sort | TZ=UTC zip -q -X -9 -@ "$OLDPWD/out/packages/$name.zip")
echo "unpacked: $(du -sm "$root" | cut -f1) MB, $(ls "$root/lib" | wc -l) libraries"
ls -l "out/packages/$name".*
