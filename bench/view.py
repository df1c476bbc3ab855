# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages of `swath view` in a Chromium without a screen, drawn by software (SwiftShader): size, time to the first picture, pictures per second.

  python3 bench/view.py PAGE.html [...] [--seconds 10]
"""
import argparse
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "cli"))
import chromium  # noqa: E402


def main():
    p = argparse.ArgumentParser()
    p.add_argument("pages", nargs="+", type=Path)
    p.add_argument("--seconds", type=float, default=10)
    a = p.parse_args()
    print("page, points, MB, seconds to the first picture, to all points, pictures per second (all points), (a quarter), (2 %)")
    for page in a.pages:
        with tempfile.TemporaryDirectory() as folder, chromium.Page(folder) as b:
            begin = time.monotonic()
            state = b.open(page.resolve().as_uri(), 300)
            waited = time.monotonic() - begin
            if state != "ready" or b.console:
                sys.exit(f"{page}: {state}: {b.console}")
            first = b.value("swathView.firstPicture / 1000")
            b.wait("swathView.view.done >= 1 && !swathView.view.pending", 300)
            # What is asked for is drawn once its pixels can be read.
            b.value("swathView.view.renderer.getContext().readPixels(0, 0, 1, 1, 6408, 5121, new Uint8Array(4))")
            whole = time.monotonic() - begin
            rates = [b.value(f"swathView.view.frameRate({a.seconds}, {share})") for share in (1, 0.25, 0.02)]
            print(f"{page.name}, {b.value('swathView.cloud.size')}, {page.stat().st_size / 1e6:.1f}, {min(first, waited):.2f}, {whole:.2f}, " +
                  ", ".join(f"{r:.1f}" for r in rates), flush=True)


if __name__ == "__main__":
    main()
