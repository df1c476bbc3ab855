#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what building, running and testing swath needs and this Debian 12 or Ubuntu 24.04 lacks.
set -euo pipefail
packages=(
  build-essential cmake ninja-build ccache git ca-certificates
  libeigen3-dev libcgal-dev libpcl-dev liboctomap-dev libtbb-dev libgdal-dev libproj-dev proj-data libpng-dev
  libtomlplusplus-dev rapidjson-dev libcli11-dev libxxhash-dev libgtest-dev
  python3 python3-venv clang-format
)
command -v cargo >/dev/null 2>&1 || packages+=(cargo rustc)
missing=()
for p in "${packages[@]}"; do
  dpkg-query -W -f='${db:Status-Status}' "$p" 2>/dev/null | grep -qx installed || missing+=("$p")
done
[ "${#missing[@]}" -eq 0 ] && exit 0
echo "installing: ${missing[*]}"
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
