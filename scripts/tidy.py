# SPDX-License-Identifier: GPL-3.0-or-later
"""tidy.py BUILD TIDY JOBS: clang-tidy over the folders that BUILD compiles as one, and over its other files of the rooms. Exit 1 on a finding.

A file without findings is known by the hash of its preprocessed text with comments (NOLINT is one), of .clang-tidy and of the program's version, and is
not looked at again until one of them changes: SWATH_TIDY_CACHE, or swath/tidy in the user's cache; an empty value turns this off."""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

ROOT = pathlib.Path.cwd()


def cache_folder():
    usual = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "swath" / "tidy"
    stated = os.environ.get("SWATH_TIDY_CACHE", str(usual))
    return pathlib.Path(stated) if stated else None


def entries_of(build):
    """The folders are the files named Unity; a unit with options of its own stays alone."""
    out = []
    for entry in json.loads((build / "compile_commands.json").read_text()):
        file = pathlib.Path(entry["file"])
        if "/Unity/" in str(file) or (ROOT in file.parents and file.relative_to(ROOT).parts[0] not in ("tests", "bench", "build")):
            # Clang does not know some of GCC's options, and needs none that instruments.
            entry["command"] = re.sub(r" \S*(-fsanitize|-fno-sanitize|-fprofile|--coverage|-W)\S*", "", entry["command"])
            out.append(entry)
    return out


def key_of(entry, settings):
    """None where it cannot be preprocessed: clang-tidy says why."""
    words = shlex.split(entry["command"])
    at = words.index("-o")
    done = subprocess.run(words[:at] + words[at + 2:] + ["-E", "-C", "-w"], cwd=entry["directory"], capture_output=True)
    if done.returncode:
        return None
    return hashlib.sha256(settings + done.stdout.replace(str(ROOT).encode(), b"")).hexdigest()


def look_at(entry, tidy, settings, cache):
    """Findings, None where it is known to have none."""
    key = key_of(entry, settings) if cache else None
    if key and (cache / key).exists():
        return None
    done = subprocess.run([tidy, "-p", "build/tidy", "--quiet", entry["file"]], capture_output=True, text=True)
    if done.returncode == 0 and not done.stdout.strip():
        if key:
            (cache / key).touch()
        return ""
    return (done.stdout + done.stderr).strip() or f"{entry['file']}: clang-tidy ends with {done.returncode}"


def main():
    build, tidy, jobs = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], int(sys.argv[3])
    entries = entries_of(build)
    pathlib.Path("build/tidy/compile_commands.json").write_text(json.dumps(entries))
    cache = cache_folder()
    if cache:
        cache.mkdir(parents=True, exist_ok=True)
    settings = subprocess.run([tidy, "--version"], capture_output=True).stdout + pathlib.Path(".clang-tidy").read_bytes()
    print(f"clang-tidy: {len(entries)} files, with {tidy}", flush=True)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        results = list(pool.map(lambda entry: look_at(entry, tidy, settings, cache), entries))
    found = [r for r in results if r]
    print("\n".join(found + [f"clang-tidy: {len(found)} with findings, {sum(r is None for r in results)} as they were when they had none"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
