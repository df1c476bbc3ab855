#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Surveys of about 10 and 40 million returns at the same density, for run.sh: bench/surveys.sh SWATH FOLDER
set -euo pipefail
swath=$1 folder=$2
mkdir -p "$folder"
for length in 1600 6400; do
  "$swath" simulate "$folder/length_$length" --quiet --set world.length="$length m" --set world.width="700 m" --set flight.lines=3 \
    --set flight.overlap=0.2 --set flight.cross_lines=0 --set scanner.prf="100 kHz" --set scanner.frequency="60 Hz" \
    --set 'output.formats=["las"]' --set imu.file=false --set gnss.file=false
done
