#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The main job: builds swath, simulates a survey, takes its raw records to products, and tells the errors against truth.
set -euo pipefail
cd "$(dirname "$0")/.."
bash scripts/install.sh
cmake --preset release -DSWATH_TESTS=OFF
cmake --build build/release
build/release/tools/swath simulate out/demo
build/release/tools/swath run configs/survey.toml --survey out/demo/survey.toml --output out/products
echo "picture: out/products/relief.png"
