#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes out/packages/swath-*.whl, which holds the Python module, the program, every library that they need beside the C library's and the
# compiler's own, PROJ's database and the charts' typeface: package_wheel.sh [PYTHON]
# Compiled by folders, as scripts/test.sh does, so that ccache has its objects (SWATH_UNITY=OFF: one by one). SOURCE_DATE_EPOCH dates the files; without it the last commit.
set -euo pipefail
cd "$(dirname "$0")/.."
python="${1:-python3}"
if [ -z "${SOURCE_DATE_EPOCH:-}" ]; then
  SOURCE_DATE_EPOCH="$(git log -1 --format=%ct 2>/dev/null || date +%s)"
fi
export SOURCE_DATE_EPOCH
umask 022
tools="$PWD/build/wheel_tools"
"$python" tests/io/laspy_environment.py "$tools" scripts/wheel_requirements.txt || exit 1
export PATH="$tools/bin:$PATH"
rm -rf build/wheel_raw build/wheel_repaired
python -m build --wheel --no-isolation --skip-dependency-check "-Ccmake.define.SWATH_UNITY=${SWATH_UNITY:-ON}" -Ccmake.define.SWATH_PAGES=ON \
  -Ccmake.define.CMAKE_CXX_COMPILER="${CXX:-c++}" --outdir build/wheel_raw .
bash scripts/build_gdal.sh # the small one, found before the system's
LD_LIBRARY_PATH="$PWD/build/gdal/lib" auditwheel repair --wheel-dir build/wheel_repaired build/wheel_raw/swath-*.whl
mkdir -p out/packages
rm -f out/packages/swath-*.whl
python scripts/finish_wheel.py build/wheel_repaired/swath-*.whl out/packages
ls -l out/packages/swath-*.whl
