# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the virtual environment of a check: laspy_environment.py FOLDER REQUIREMENTS.

Exit code 77 (skipped) where the packages cannot be fetched.
"""
import pathlib
import subprocess
import sys
import venv

folder, requirements = map(pathlib.Path, sys.argv[1:])
stamp = folder / "complete"
wanted = requirements.read_text()
if stamp.exists() and stamp.read_text() == wanted:
    sys.exit(0)
try:
    venv.create(folder, with_pip=True, clear=True)
except (OSError, subprocess.CalledProcessError) as fault:
    print(f"SKIPPED: no virtual environment can be made ({fault}); Debian: apt install python3-venv")
    sys.exit(77)
pip = [str(folder / "bin/python"), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--retries", "1", "-r", str(requirements)]
done = subprocess.run(pip, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
if done.returncode:
    print(done.stdout)
    print(f"SKIPPED: pip cannot install {requirements.name} (no network, or no build for this Python)")
    sys.exit(77)
stamp.write_text(wanted)
