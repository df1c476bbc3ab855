# SPDX-License-Identifier: GPL-3.0-or-later
"""The calibration report as its reader meets it: its figures computed again from the files beside it, its page in a browser."""
import html
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import unittest
import zlib

import report_figures
from support import Case, substitute

SAMPLE = os.environ["SWATH_CALIBRATION_SAMPLE"]
SKIPPED = 77  # as tests/cli/CMakeLists.txt tells ctest


def made(folder, which="whole"):
    subprocess.run([SAMPLE, str(folder), which], check=True, timeout=120)
    return folder


class Figures(Case):
    def test_every_figure_follows_from_the_files(self):
        for which in ("whole", "refused"):
            self.assertEqual(report_figures.check(made(self.folder / which, which)), [])

    def test_what_does_not_agree_is_seen(self):
        """The check can fail: one number changed in each file."""
        good = made(self.folder / "good")

        def column(file, name):
            """The name's value in the first row after the header becomes another."""
            def spoil(folder):
                lines = (folder / file).read_text().split("\n")
                k = lines[0].split(",").index(name)
                fields = lines[1].split(",")
                fields[k] = str(float(fields[k]) + 0.5)
                lines[1] = ",".join(fields)
                (folder / file).write_text("\n".join(lines))
            return spoil

        def tree(change):
            def spoil(folder):
                file = folder / "calibration.json"
                values = json.loads(file.read_text())
                change(values)
                file.write_text(json.dumps(values))
            return spoil

        spoilers = {
            "residuals-by-angle": column("residuals.csv", "after_m"),
            "table corrections": column("corrections.csv", "north_m"),
            "table sections": lambda f: (f / "sections.csv").write_text((f / "sections.csv").read_text() + "0,after,1,2.5,410.0\n"),
            "table planes": lambda f: substitute(f / "planes.csv", "1,target,", "1,roof,"),
            "table differences": lambda f: shutil.copy(f / "differences/1_3_after.tif", f / "differences/1_2_after.tif"),
            "values-angles": tree(lambda t: t["estimates"][0].update(value=0.0)),
            "sigma of boresight_pitch": tree(lambda t: t["sigma"].update(pitch="0.001 deg")),
            "the verdict": tree(lambda t: t.update(verdict="All is well.")),
            "follows from no file": tree(lambda t: t["estimates"][2].update(sigma=1.0)),
            "target-readings": tree(lambda t: t["flat_target"]["roll"]["readings"][1].update(value_deg=7.0)),
            "target-lines": tree(lambda t: t["flat_target"]["lines"][0]["after"].update(along_m=7.0)),
        }
        for words, spoil in spoilers.items():
            with self.subTest(words):
                folder = self.folder / "spoiled"
                shutil.rmtree(folder, ignore_errors=True)
                shutil.copytree(good, folder)
                spoil(folder)
                self.assertIn(words, "\n".join(report_figures.check(folder)))


def browser():
    """A Chromium that runs without a screen, or nothing (a package may be a mere stub that asks for another kind of package)."""
    for name in ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome"):
        path = shutil.which(name)
        if path and subprocess.run([path, "--version"], capture_output=True, timeout=60).returncode == 0:
            return path
    return None


def pixels(file):
    """Width, height and the set of colours of an 8-bit PNG, with how many pixels have each."""
    data = file.read_bytes()
    width, height, depth, kind = struct.unpack_from(">IIBB", data, 16)
    assert depth == 8 and kind in (2, 6)
    size, at, packed = {2: 3, 6: 4}[kind], 8, b""
    while at < len(data):
        length, name = struct.unpack_from(">I4s", data, at)
        packed += data[at + 8:at + 8 + length] if name == b"IDAT" else b""
        at += 12 + length
    raw, stride, before, counts = zlib.decompress(packed), width * size, bytearray(width * size), {}
    for y in range(height):
        method, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left, up, corner = row[x - size] if x >= size else 0, before[x], before[x - size] if x >= size else 0
            if method == 1:
                row[x] = row[x] + left & 255
            elif method == 2:
                row[x] = row[x] + up & 255
            elif method == 3:
                row[x] = row[x] + (left + up) // 2 & 255
            elif method == 4:
                guess = left + up - corner
                nearest = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
                row[x] = row[x] + nearest & 255
        for x in range(0, stride, size):
            colour = bytes(row[x:x + 3])
            counts[colour] = counts.get(colour, 0) + 1
        before = row
    return width, height, counts


# Looks at the page from within: widths of its pictures, what is wider than the window, letters of drawings outside of them or on one another.
PROBE = """<script>
const out = {images: [], svgs: 0, outside: [], overlaps: [], missing: []};
for (const i of document.images) out.images.push([i.naturalWidth, i.getBoundingClientRect().width]);
out.overflow = document.documentElement.scrollWidth - document.documentElement.clientWidth;
for (const s of document.querySelectorAll('figure svg')) {
  ++out.svgs;
  const frame = s.getBoundingClientRect(), boxes = [];
  for (const t of s.querySelectorAll('text')) {
    const b = t.getBoundingClientRect();
    if (b.left < frame.left - 1 || b.right > frame.right + 1 || b.top < frame.top - 1 || b.bottom > frame.bottom + 1)
      out.outside.push(t.textContent);
    // A line's box is taller than its letters by some fifth at both ends.
    const up = t.hasAttribute('transform'), dx = up ? b.width / 5 : 0, dy = up ? 0 : b.height / 5;
    const mine = {text: t.textContent, l: b.left + dx, r: b.right - dx, t: b.top + dy, b: b.bottom - dy};
    for (const o of boxes) if (mine.l < o.r && o.l < mine.r && mine.t < o.b && o.t < mine.b) out.overlaps.push([mine.text, o.text]);
    boxes.push(mine);
  }
}
for (const a of document.querySelectorAll('a[href^="#"]'))
  if (!document.getElementById(a.getAttribute('href').slice(1))) out.missing.push(a.getAttribute('href'));
const all = document.querySelectorAll('[id]'), ids = new Set(Array.from(all, e => e.id));
out.twice = all.length - ids.size;
document.documentElement.setAttribute('data-probe', JSON.stringify(out));
</script></body>"""


class Browser(Case):
    CHROMIUM = browser()

    def setUp(self):
        super().setUp()
        if not self.CHROMIUM:
            self.skipTest("no Chromium that runs without a screen is installed")
        self.page = made(self.folder / "report") / "report.html"

    def chromium(self, page, *options):
        return subprocess.run(
            [self.CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
             f"--user-data-dir={self.folder / 'profile'}", "--enable-logging=stderr", *options, page.as_uri()],
            capture_output=True, text=True, timeout=120, env={**os.environ, "HOME": str(self.folder)})

    def probe(self, width):
        """The page with the probe added, which its own policy would not let run."""
        text = self.page.read_text()
        probed = self.folder / "probed.html"
        probed.write_text(re.sub(r"<meta http-equiv=.*?>", "", text).replace("</body>", PROBE))
        done = self.chromium(probed, f"--window-size={width},900", "--dump-dom")
        found = re.search(r'data-probe="(.*?)"', done.stdout)
        self.assertIsNotNone(found, done.stderr)
        return json.loads(html.unescape(found.group(1)))

    def test_the_page_is_whole(self):
        done = self.chromium(self.page, "--dump-dom")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("CONSOLE", done.stderr)
        tree = json.loads((self.page.parent / "calibration.json").read_text())
        self.assertIn(tree["verdict"], html.unescape(done.stdout))
        self.assertIn("Calibrated: boresight roll, pitch and heading are known to", tree["verdict"])
        self.assertIn("Airfield &lt;north&gt; &amp; town", done.stdout)

    def test_a_fault_on_the_page_would_be_seen(self):
        self.page.write_text(self.page.read_text().replace("</body>", '<script>1</script><img src="nowhere.png"></body>'))
        self.assertIn("CONSOLE", self.chromium(self.page, "--dump-dom").stderr)
        self.assertIn(0, [width for width, _ in self.probe(1280)["images"]])

    def test_pictures_and_letters_are_in_their_places(self):
        for width in (1280, 700):
            with self.subTest(width):
                seen = self.probe(width)
                self.assertEqual(len(seen["images"]), 6)
                self.assertTrue(all(natural > 700 and shown > 400 for natural, shown in seen["images"]), seen["images"])
                self.assertEqual(seen["svgs"], 7)
                self.assertEqual(seen["outside"], [])
                self.assertEqual(seen["overlaps"], [])
                self.assertEqual(seen["missing"], [])
                self.assertEqual(seen["twice"], 0)
                self.assertLessEqual(seen["overflow"], 0)

    def test_the_page_is_not_blank(self):
        picture = self.folder / "page.png"
        done = self.chromium(self.page, "--window-size=900,700", f"--screenshot={picture}")
        self.assertTrue(picture.is_file(), done.stderr)
        width, height, counts = pixels(picture)
        self.assertEqual((width, height), (900, 700))
        # Letters have many shades of ink; a page that could not be shown has one or two.
        self.assertGreater(len(counts), 40)
        ink = sum(n for colour, n in counts.items() if max(colour) < 110)
        self.assertGreater(ink, 0.005 * width * height)

    def test_it_prints(self):
        paper = self.folder / "report.pdf"
        done = self.chromium(self.page, f"--print-to-pdf={paper}", "--no-pdf-header-footer")
        self.assertTrue(paper.is_file(), done.stderr)
        self.assertGreater(paper.read_bytes().count(b"/Type /Page\n"), 5)


if __name__ == "__main__":
    result = unittest.main(exit=False).result
    nothing_ran = result.testsRun > 0 and len(result.skipped) == result.testsRun
    sys.exit(SKIPPED if nothing_ran else not result.wasSuccessful())
