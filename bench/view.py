# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages of `swath view` in a Chromium without a screen, drawn by software (SwiftShader): size, and what the first picture, all points and one
picture of the turning view take, in seconds of the clock and of processor time of all the browser's processes, which a busy machine changes less.

  python3 bench/view.py PAGE.html [...] [--pictures 3]
"""
import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "cli"))
import chromium  # noqa: E402

TICK = os.sysconf("SC_CLK_TCK")


def family(root):
    """The processes below one, itself included, with their fields in /proc."""
    stats = {}
    for p in Path("/proc").iterdir():
        if p.name.isdigit():
            try:
                stats[int(p.name)] = (p / "stat").read_text().rsplit(")", 1)[1].split()
            except OSError:
                pass
    found, todo = {}, [root]
    while todo:
        pid = todo.pop()
        if pid in stats:
            found[pid] = stats[pid]
            todo += [k for k, s in stats.items() if int(s[1]) == pid]
    return found


class Clock:
    def __init__(self, root):
        self.root, self.wall, self.cpu = root, time.monotonic(), self.spent(root)

    @staticmethod
    def spent(root):
        return sum(int(s[11]) + int(s[12]) for s in family(root).values()) / TICK

    def __call__(self):
        return f"{time.monotonic() - self.wall:.2f} ({self.spent(self.root) - self.cpu:.2f})"


def held(root):
    """Bytes of memory, shared pages counted once."""
    total = 0
    for pid in family(root):
        try:
            total += next(1024 * int(line.split()[1]) for line in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines() if line.startswith("Pss:"))
        except (OSError, StopIteration):
            pass
    return total


TURN = """(async (n, share) => { const v = swathView.view, gl = v.renderer.getContext(), p = new Uint8Array(4); v.moving = true;
  for (let k = 0; k < n; ++k) { v.camera.position.applyAxisAngle(v.camera.up, 0.02); v.camera.lookAt(v.controls.target); v.drawNow(share);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, p); } v.moving = false; })"""


def main():
    p = argparse.ArgumentParser()
    p.add_argument("pages", nargs="+", type=Path)
    p.add_argument("--pictures", type=int, default=3)
    a = p.parse_args()
    print("seconds (of processor time): page | points | MB | first picture | all points | MB of memory | a picture of all points | of 5 % of them")
    for page in a.pages:
        with tempfile.TemporaryDirectory() as folder, chromium.Page(folder) as b:
            root = b._process.pid
            clock = Clock(root)
            state = b.open(page.resolve().as_uri(), 300)
            first = clock()
            if state != "ready" or b.console:
                sys.exit(f"{page}: {state}: {b.console}")
            b.wait("swathView.view.done >= 1 && !swathView.view.pending", 300)
            # What is asked for is drawn once its pixels can be read.
            b.value("swathView.view.renderer.getContext().readPixels(0, 0, 1, 1, 6408, 5121, new Uint8Array(4))")
            whole, memory = clock(), held(root)
            turns = []
            for share in (1, 0.05):
                b.value(f"{TURN}(1, {share})")
                turn = Clock(root)
                b.value(f"{TURN}({a.pictures}, {share})")
                wall, cpu = (float(v.strip("()")) / a.pictures for v in turn().split())
                turns.append(f"{wall:.2f} ({cpu:.2f})")
            print(f"{page.name} | {b.value('swathView.cloud.size')} | {page.stat().st_size / 1e6:.1f} | {first} | {whole} | {memory / 1e6:.0f} | " + " | ".join(turns),
                  flush=True)


if __name__ == "__main__":
    main()
