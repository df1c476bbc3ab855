#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs each package of out/packages in a bare system made by debootstrap and runs `swath demo` there as a normal user. As root.
#   bash scripts/test_packages.sh [SUITE [MIRROR]]     SUITE: bookworm (Debian 12); another needs packages that were built on it
# SWATH_PACKAGES: other packages than those; SWATH_ROOTS: where the systems are made; SWATH_PICTURE: a relief.png that the demonstration's must equal.
set -euo pipefail
cd "$(dirname "$0")/.."
suite="${1:-bookworm}"
mirror="${2:-}"
[ "$(id -u)" -eq 0 ] || { echo "swath: as root, for debootstrap and chroot" >&2; exit 1; }
command -v debootstrap >/dev/null || { echo "swath: debootstrap is missing; apt-get install debootstrap" >&2; exit 1; }
work="${SWATH_ROOTS:-build/roots}"
mkdir -p "$work"
work="$(realpath "$work")"
bare="$work/$suite"
[ -e "$bare/etc/os-release" ] || debootstrap --variant=minbase "$suite" "$bare" $mirror >"$work/$suite.log"

root=""
leave() {
  if [ -n "$root" ]; then
    mountpoint -q "$root/proc" && umount "$root/proc"
    rm -rf --one-file-system "$root"
  fi
}
trap leave EXIT

fresh() { # a copy of the bare system with a user, in `root`
  leave
  root="$work/test"
  rm -rf --one-file-system "$root"
  cp -a "$bare" "$root"
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  mount -t proc proc "$root/proc"
  chroot "$root" useradd --create-home surveyor
}

demo() { # a program within the root
  local began ended
  began="$(date +%s.%N)"
  chroot "$root" su - surveyor -c "$1 --version && $1 demo && $1 view swath-demo/products --save view.html" >"$work/demo.txt" 2>"$work/demo.log" || { tail -n 5 "$work/demo.txt" "$work/demo.log" >&2; return 1; }
  ended="$(date +%s.%N)"
  for product in dtm.vrt relief.png contours.gpkg report.json; do
    [ -s "$root/home/surveyor/swath-demo/products/$product" ] || { echo "swath: no $product" >&2; return 1; }
  done
  [ -s "$root/home/surveyor/view.html" ] || { echo "swath: no view.html" >&2; return 1; }
  cmp -s "$root/home/surveyor/swath-demo/products/relief.png" "${SWATH_PICTURE:-/dev/null}" && echo "  the picture is that of SWATH_PICTURE"
  awk -v a="$began" -v b="$ended" 'BEGIN { printf "  demo and page: %.0f s\n", b - a }'
  du -xsm "$root/home/surveyor/swath-demo/products" | awk '{ print "  products: " $1 " MB" }'
}

for package in ${SWATH_PACKAGES:-out/packages/*.deb out/packages/*.tar.zst out/packages/*.zip out/packages/*.whl}; do
  [ -e "$package" ] || continue
  echo "== $(basename "$package"), $(stat -c %s "$package") bytes, in a bare $suite"
  fresh
  chroot "$root" sh -c 'apt-get update -q && apt-get clean' >"$work/apt.log" 2>&1 || { tail -5 "$work/apt.log" >&2; exit 1; }  # lists are not counted
  if [ "${package##*.}" = whl ]; then
    # The interpreter is the system's and counted with it; NumPy is fetched out here and counted.
    chroot "$root" sh -c 'DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends python3 python3-venv && apt-get clean' >"$work/apt.log" 2>&1 ||
      { tail -20 "$work/apt.log" >&2; exit 1; }
    mkdir -p "$root/tmp/wheels"
    python3 -m pip download --quiet --disable-pip-version-check --only-binary :all: --no-deps \
      --python-version "$(chroot "$root" python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')" --dest "$root/tmp/wheels" numpy
  fi
  before="$(du -xsm "$root" | cut -f1)"
  case "$package" in
    *.deb)
      cp "$package" "$root/tmp/swath.deb"
      began="$(date +%s)"
      chroot "$root" sh -c 'DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends /tmp/swath.deb' >"$work/apt.log" 2>&1 ||
        { tail -20 "$work/apt.log" >&2; exit 1; }
      echo "  apt: $(($(date +%s) - began)) s"
      chroot "$root" sh -c 'rm -f /tmp/swath.deb; apt-get clean'
      program=swath
      ;;
    *.tar.zst)
      zstd -q -dc "$package" | tar -C "$root/home/surveyor" -xf -
      program="$(cd "$root" && echo home/surveyor/swath-*/bin/swath)"
      program="/$program"
      ;;
    *.zip)
      unzip -q "$package" -d "$root/home/surveyor"
      program="$(cd "$root" && echo home/surveyor/swath-*/bin/swath)"
      program="/$program"
      ;;
    *.whl)
      cp "$package" scripts/test_wheel.py "$root/tmp/wheels/"
      chmod -R a+rX "$root/tmp/wheels"
      chroot "$root" su - surveyor -c 'python3 -m venv venv && du -sm venv' >"$work/venv.log"
      began="$(date +%s)"
      chroot "$root" su - surveyor -c 'venv/bin/pip install --quiet --no-index --find-links /tmp/wheels swath && venv/bin/pip check' >"$work/pip.log" 2>&1 ||
        { tail -20 "$work/pip.log" >&2; exit 1; }
      echo "  pip: $(($(date +%s) - began)) s"
      rm -f "$root"/tmp/wheels/*.whl
      program=venv/bin/swath
      ;;
  esac
  chroot "$root" chown -R surveyor: /home/surveyor
  echo "  installed: $(($(du -xsm "$root" | cut -f1) - before)) MB"
  demo "$program"
  if [ "${package##*.}" = whl ]; then
    chroot "$root" su - surveyor -c 'mkdir -p test && cd test && ../venv/bin/python /tmp/wheels/test_wheel.py ../swath-demo/products'
  fi
done
echo "every package installs and runs"
