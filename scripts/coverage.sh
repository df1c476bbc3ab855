#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# coverage.sh [--state] [BUILD]: the share of each room's lines that ran since BUILD (build/ci) was built with SWATH_COVERAGE, held against
# .ci/coverage. Exit 1 where a room or the whole lies more than 0.3 points below; --state writes today's shares there.
set -euo pipefail
cd "$(dirname "$0")/.."
exec python3 - "$@" <<'PY'
import concurrent.futures, json, os, pathlib, subprocess, sys

arguments = [a for a in sys.argv[1:] if a != "--state"]
build = pathlib.Path(arguments[0] if arguments else "build/ci").resolve()
root = pathlib.Path.cwd().resolve()
floors = root / ".ci/coverage"
TOLERANCE = 0.3  # points: threads and the machine's memory decide which of two ways a few lines go

def counts(data):
    made = subprocess.run(["gcov", "--json-format", "--stdout", str(data)], cwd=build, capture_output=True, text=True, check=True).stdout
    found = []
    for document in made.splitlines():
        document = json.loads(document)
        for file in document["files"]:
            path = pathlib.Path(os.path.normpath(pathlib.Path(document["current_working_directory"]) / file["file"]))
            if root in path.parents and build not in path.parents and path.relative_to(root).parts[0] not in ("tests", "build"):
                found.append((path, [(line["line_number"], line["count"] > 0) for line in file["lines"]]))
    return found

lines = {}  # file -> {line: whether it ran}; a header's lines run where any unit runs them
written = sorted(build.rglob("*.gcda"))
if not written:
    sys.exit(f"coverage: no counts in {build}: configure with SWATH_COVERAGE=ON (the preset ci has it), build, run the tests")
with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    for found in pool.map(counts, written):
        for path, ran in found:
            file = lines.setdefault(path, {})
            for number, did in ran:
                file[number] = file.get(number, False) or did
rooms = {}
for path, file in lines.items():
    for room in (path.relative_to(root).parts[0], "all"):
        ran, there = rooms.get(room, (0, 0))
        rooms[room] = (ran + sum(file.values()), there + len(file))
share = {room: 100 * ran / there for room, (ran, there) in rooms.items()}
if "--state" in sys.argv:
    floors.write_text("".join(f"{room} {share[room]:.1f}\n" for room in sorted(share)))
stated = {room: float(floor) for room, floor in (line.split() for line in floors.read_text().splitlines())}
low = [room for room, floor in stated.items() if share.get(room, 0.0) < floor - TOLERANCE]
print(f"{'room':<12}{'lines':>8}{'ran':>9}{'stated':>9}")
for room in sorted(share):
    print(f"{room:<12}{rooms[room][1]:>8}{share[room]:>8.1f}%{stated.get(room, 0.0):>8.1f}%{'  too low' if room in low else ''}")
missing = sorted(set(share) - set(stated))
if missing:
    sys.exit(f"coverage: {', '.join(missing)} is not stated in .ci/coverage: scripts/coverage.sh --state")
if low:
    sys.exit(f"coverage: {', '.join(low)} lies below what .ci/coverage states: test the new lines (gcov names them)")
PY
