#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what building, running and testing swath needs and this Debian 12 or Ubuntu 24.04 lacks.
set -euo pipefail
packages=(
  build-essential cmake ninja-build ccache git ca-certificates
  libeigen3-dev libcgal-dev libpcl-dev liboctomap-dev libceres-dev libtbb-dev libgdal-dev libproj-dev proj-data libpng-dev
  libcairo2-dev fonts-dejavu-core # charts and maps, and their typeface
  pkg-config libcpp-httplib-dev # the web server of swath view
  libtomlplusplus-dev rapidjson-dev libcli11-dev libxxhash-dev libzstd-dev libgtest-dev
  python3 python3-venv python3-dev clang-format
  rtklib # runs, it is not linked: raw GNSS observations go through its rnx2rtkp
)
# The LAZ coder needs Rust 1.66 or newer: Debian 12 has it as cargo-web, Ubuntu 24.04 as cargo.
minor=0
if command -v cargo >/dev/null; then minor="$(cargo --version | sed -n 's/^cargo 1\.\([0-9]*\).*/\1/p')"; fi
if [ "${minor:-0}" -lt 66 ]; then
  if grep -q '^VERSION_CODENAME=bookworm' /etc/os-release; then packages+=(cargo-web rustc-web); else packages+=(cargo rustc); fi
fi
# Reports are opened in a browser. Debian 12 has one without a screen; Ubuntu's package is a stub for a snap, and the test says that it is left out.
if grep -q '^VERSION_CODENAME=bookworm' /etc/os-release; then packages+=(chromium-headless-shell); fi
missing=()
for p in "${packages[@]}"; do
  dpkg-query -W -f='${db:Status-Status}' "$p" 2>/dev/null | grep -qx installed || missing+=("$p")
done
[ "${#missing[@]}" -eq 0 ] && exit 0
echo "installing: ${missing[*]}"
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "swath: no sudo here; as root: apt-get install --no-install-recommends ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
