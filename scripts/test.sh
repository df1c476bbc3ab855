#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds swath and passes its tests.
set -euo pipefail
cd "$(dirname "$0")/.."
bash scripts/install.sh
cmake --preset release -DSWATH_TESTS=ON -DSWATH_UNITY=ON
cmake --build build/release
ctest --preset release -j "$(nproc)"
