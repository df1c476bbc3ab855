#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The main job: builds swath, simulates a survey, takes its raw records to products, and reports the errors against truth.
set -euo pipefail
cd "$(dirname "$0")/.."
bash scripts/install.sh
cmake --preset release -DSWATH_TESTS=OFF
cmake --build build/release
build/release/tools/swath demo --output out
