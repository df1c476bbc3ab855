# SPDX-License-Identifier: GPL-3.0-or-later
"""swath view: the page that it writes and the server that it starts, as a browser meets them."""
import html
import http.client
import json
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import unittest
import zlib

import chromium
from support import CONFIG, Case, SMALL, SOURCE, SWATH, in_crs, south_up, swath, write_las

SKIPPED = 77  # as tests/cli/CMakeLists.txt has it
WITHOUT_PAGES = "built without its pages" in swath("view", "/nowhere").stderr
COPC = SOURCE / "configs" / "copc.toml"


def pixels(png):
    """{colour: pixels} of an 8-bit PNG without interlacing."""
    width, height, depth, kind = struct.unpack_from(">IIBB", png, 16)
    assert depth == 8 and kind in (2, 6)
    size, at, packed = {2: 3, 6: 4}[kind], 8, b""
    while at < len(png):
        length, name = struct.unpack_from(">I4s", png, at)
        packed += png[at + 8:at + 8 + length] if name == b"IDAT" else b""
        at += 12 + length
    raw, stride, before, counts = zlib.decompress(packed), width * size, bytearray(width * size), {}
    for y in range(height):
        method, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left, up, corner = row[x - size] if x >= size else 0, before[x], before[x - size] if x >= size else 0
            near = min((abs(up - corner), 0, left), (abs(left - corner), 1, up), (abs(left + up - 2 * corner), 2, corner))[2]
            row[x] = row[x] + (0, left, up, (left + up) // 2, near)[method] & 255
        for x in range(0, stride, size):
            counts[bytes(row[x:x + 3])] = counts.get(bytes(row[x:x + 3]), 0) + 1
        before = row
    return counts


BACKGROUND = bytes((0x10, 0x14, 0x1a))
# The picture as it is drawn for this: pixels of the canvas that are not background.
DRAWN = """(() => { const v = swathView.view, gl = v.renderer.getContext(), w = gl.drawingBufferWidth, h = gl.drawingBufferHeight, p = new Uint8Array(4 * w * h);
  v.drawNow(1); gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, p);
  let n = 0; const colours = new Set();
  for (let k = 0; k < p.length; k += 4) if (p[k] !== 0x10 || p[k + 1] !== 0x14 || p[k + 2] !== 0x1a) { ++n; colours.add(p[k] << 16 | p[k + 1] << 8 | p[k + 2]); }
  return {share: n / (w * h), colours: colours.size}; })()"""


def only(layer):
    """Shows that layer alone."""
    return f"""for (const e of document.querySelectorAll('#layers input')) if (e.checked !== (e.id === 'layer-{layer}')) e.click(); 0"""


class Pages(Case):
    """A survey with its products, run once."""
    simulated = SMALL

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        if WITHOUT_PAGES:
            raise unittest.SkipTest("this swath was built without its pages")
        cls.products = cls.class_folder / "products"
        survey = cls.survey / "survey.toml"
        # What a file says is text, whatever it holds.
        survey.write_text(re.sub(r'^name = ".*"', 'name = "</script><script>alert(1)</script>{{scene}}&amp;"', survey.read_text(), flags=re.M))
        done = swath("run", CONFIG, "--survey", survey, "--output", cls.products, "--quiet")
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        shutil.copy(cls.survey / "sbet.out", cls.products / "trajectory.sbet")  # of a run that estimates one: writers.trajectory

    def browser(self, **keywords):
        if not chromium.program():
            self.skipTest("no Chromium that runs without a screen is installed")
        return chromium.Page(self.folder, **keywords)


class Saved(Pages):
    def saved(self, *more, of=None):
        page = self.folder / "view.html"
        done = swath("view", of or self.products, "--save", page, *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return page, done.stdout

    def test_the_page_opens_alone(self):
        page, said = self.saved()
        self.assertRegex(said, r"view\.html: .*of.*points, .*MB")
        lonely = self.folder / "elsewhere" / "page.html"
        lonely.parent.mkdir()
        shutil.move(page, lonely)
        with self.browser() as b:
            self.assertEqual(b.open(lonely.as_uri()), "ready")
            self.assertEqual(b.console, [])
            self.assertEqual([r for r in b.requests if not r.startswith(("data:", "blob:"))], [lonely.as_uri()])
            self.assertEqual(b.value("document.title"), "</script><script>alert(1)</script>{{scene}}&amp;")
            shown = b.value("swathView.cloud.size")
            self.assertEqual(shown, b.value("swathView.scene.points.of"))
            seen = b.value(DRAWN)
            self.assertGreater(seen["share"], 0.2)
            self.assertGreater(seen["colours"], 50)
            b.screenshot(self.folder / "page.png")
            counts = pixels((self.folder / "page.png").read_bytes())
            self.assertLess(counts.get(BACKGROUND, 0), 0.75 * sum(counts.values()))

    def test_every_layer_and_colouring_is_drawn(self):
        page, _ = self.saved()
        with self.browser() as b:
            b.open(page.as_uri())
            pictures = {}
            for layer in ("points", "terrain-model", "contours", "trajectory"):
                b.value(only(layer))
                if layer == "trajectory":  # it lies far above the ground, out of the picture
                    self.assertGreater(b.value("swathView.trajectory.geometry.attributes.position.count"), 10)
                    continue
                pictures[layer] = b.value(DRAWN)
                self.assertGreater(pictures[layer]["share"], 0.0005 if layer == "contours" else 0.15, layer)
            b.value(only("nothing"))
            self.assertEqual(b.value(DRAWN)["share"], 0)
            b.value(only("points"))
            modes = b.value("Array.from(document.getElementById('mode').options, o => o.value)")
            self.assertEqual(modes, ["class", "height", "intensity", "sigma", "line"])
            seen = set()
            for mode in modes:
                b.value(f"(() => {{ const m = document.getElementById('mode'); m.value = '{mode}'; m.onchange(); }})()")
                b.value(DRAWN)
                seen.add(b.value("""(() => { const gl = swathView.view.renderer.getContext(), p = new Uint8Array(4e4);
                  swathView.view.drawNow(1); gl.readPixels(300, 300, 100, 100, gl.RGBA, gl.UNSIGNED_BYTE, p); return p.join(); })()"""))
            self.assertEqual(len(seen), 5, "two ways of colouring look alike")
            self.assertEqual(b.console, [])

    def test_a_click_shows_the_values_of_a_point(self):
        page, _ = self.saved()
        with self.browser() as b:
            b.open(page.as_uri())
            at = b.value("""(() => { const r = document.getElementById('view').getBoundingClientRect(); return [r.left + r.width / 2, r.top + r.height / 2]; })()""")
            b.click(*at)
            values = dict(b.wait("document.getElementById('picked').hidden ? null : Array.from(document.querySelectorAll('#values tr'), r => [r.children[0].textContent, r.children[1].textContent])"))
            # The middle of the picture is the place that the camera looks at.
            points = b.value("swathView.scene.points")
            target = b.value("swathView.frame.mapOfScene(swathView.view.controls.target)")
            for name, k in (("easting", 0), ("northing", 1)):
                middle = target[k]
                self.assertAlmostEqual(float(values[name].split()[0]), middle, delta=0.08 * (points["high"][k] - points["low"][k]) + 1)
            self.assertRegex(values["class"], r"^\d+ \w+")
            self.assertRegex(values["return"], r"^\d of \d$")
            self.assertRegex(values["sigma, vertical"], r"^0\.\d{3} m$")
            self.assertIn(values["flight line"], ("1", "2"))
            # What is shown is a point of the products, to the last digit.
            stored = subprocess.run([SWATH, "profile", self.products / "points", "--from", f"{float(values['easting'].split()[0]) - 1},{values['northing'].split()[0]}", "--to",
                                     f"{float(values['easting'].split()[0]) + 1},{values['northing'].split()[0]}", "--half-width", "0.5 m", "--output", self.folder, "--quiet"],
                                    capture_output=True, text=True)
            self.assertEqual(stored.returncode, 0, stored.stderr)
            rows = [line.split(",") for f in self.folder.glob("*.csv") for line in f.read_text().splitlines()]
            wanted = [values[n].split()[0] for n in ("easting", "northing", "height")]
            self.assertTrue(any(r[3:6] == wanted for r in rows), f"{wanted} is not in {rows[:20]}")
            self.assertEqual(b.console, [])

    def test_two_clicks_make_a_section(self):
        page, _ = self.saved()
        with self.browser() as b:
            b.open(page.as_uri())
            box = b.value("""(() => { const r = document.getElementById('view').getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })()""")
            b.value("document.getElementById('section').click()")
            self.assertIn("begins", b.value("document.getElementById('hint').textContent"))
            b.click(box[0] + 0.4 * box[2], box[1] + 0.5 * box[3])
            b.click(box[0] + 0.6 * box[2], box[1] + 0.5 * box[3])
            note = b.wait("document.getElementById('section-note').textContent")
            self.assertRegex(note, r"m long, strip of 4\.0 m, [\d\u202f]+ points of those shown")
            section = b.value("({n: swathView.panel.section.found, length: swathView.panel.section.length, ground: swathView.panel.section.ground.filter(p => p.z === p.z).length})")
            self.assertGreater(section["n"], 100)
            self.assertGreater(section["ground"], 20)
            rows = b.value("swathView.panel.csv(swathView.frame)").splitlines()
            self.assertEqual(sum(r.startswith("point,") for r in rows), section["n"])
            self.assertTrue(all(abs(float(r.split(",")[2])) <= 2.0 and 0 <= float(r.split(",")[1]) <= section["length"] + 0.001 for r in rows if r.startswith("point,")))
            self.assertEqual(b.console, [])

    def test_fewer_points_are_an_even_part(self):
        page, said = self.saved("--points", "5000")
        scene = json.loads(re.search(r'id="scene">(.*?)</script>', page.read_text(), re.S)[1])
        self.assertAlmostEqual(scene["points"]["shown"], 5000, delta=300)
        self.assertGreater(scene["points"]["of"], 15000)
        again, _ = self.saved("--points", "5000")
        self.assertEqual(page.read_bytes(), again.read_bytes())

    def test_without_javascript_it_says_so(self):
        page, _ = self.saved()
        with self.browser() as b:
            b.call("Emulation.setScriptExecutionDisabled", value=True)
            b.call("Page.navigate", url=page.as_uri())
            while not b.loaded:
                b._read(0.1)
            tree = b.call("DOM.getDocument", depth=-1)
            node = b.call("DOM.querySelector", nodeId=tree["root"]["nodeId"], selector="body")
            text = b.call("DOM.getOuterHTML", nodeId=node["nodeId"])["outerHTML"]
            self.assertIn("switched off here", text)
            self.assertIn("<h2>Figures</h2>", text)
            b.screenshot(self.folder / "off.png")
            self.assertGreater(len(pixels((self.folder / "off.png").read_bytes())), 20)

    def test_without_webgl_it_says_so(self):
        page, _ = self.saved("--points", "1000")
        with self.browser(options=("--disable-3d-apis",)) as b:
            self.assertEqual(b.open(page.as_uri()), "failed")
            self.assertIn("WebGL 2 is switched off or not there", b.value("document.getElementById('message').textContent"))
            b.value("document.getElementById('report-open').click()")
            self.assertIn("Figures", b.value("document.getElementById('report').innerText"))

    def test_a_damaged_page_says_so(self):
        page, _ = self.saved("--points", "1000")
        text = page.read_text()
        for old, new, words in (('id="blob-points.x">', 'id="blob-points.q">', 'does not hold "points.x"'), ('"step": ', '"step" ', "table cannot be read")):
            page.write_text(text.replace(old, new, 1))
            with self.browser() as b:
                self.assertEqual(b.open(page.as_uri()), "failed")
                self.assertIn(words, b.value("document.getElementById('message').textContent"))

    def test_texts_of_files_are_text(self):
        page, _ = self.saved()
        text = page.read_text()
        self.assertNotIn("<script>alert", text)
        self.assertIn(html.escape("</script><script>alert(1)</script>{{scene}}&amp;"), text)
        self.assertNotRegex(re.sub(r"(?s)<script>.*?</script>|<pre>.*?</pre>", "", text), r"""(?:src|href)=["'](?!data:)""")

    def test_a_cloud_without_crs_beside_one_with(self):
        tile = next((self.products / "points").glob("*.la[sz]"))
        write_las(self.folder / "bare.las", [(652000.0, 5310500.0, 700.0), (652010.0, 5310510.0, 701.0)], scale=0.01)
        for clouds in ((tile, self.folder / "bare.las"), (self.folder / "bare.las", tile)):
            done = swath("view", *clouds, "--save", self.folder / "view.html", "--quiet")
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_what_cannot_be_shown(self):
        empty = self.folder / "empty"
        empty.mkdir()
        (self.folder / "notes.txt").write_text("no cloud")
        tile = next((self.products / "points").glob("*.la[sz]"))
        broken = self.folder / "broken.laz"
        broken.write_bytes(tile.read_bytes()[:300])
        for given, code, words in ((empty, 1, "neither points nor a terrain model"), (self.folder / "nowhere", 1, "no such file"),
                                   (self.folder / "notes.txt", 2, "neither a cloud nor a folder"), (broken, 1, "broken.laz")):
            self.assert_error(swath("view", given, "--save", self.folder / "x.html"), code, words)
            self.assertFalse((self.folder / "x.html").exists())
        in_crs(self.folder / "space.las", [(4146000.0, 613000.0, 4791000.0), (4146001.0, 613001.0, 4791001.0)], (1024, 3), (2048, 4978))
        self.assert_error(swath("view", self.folder / "space.las", "--save", self.folder / "x.html", "--quiet"), 1, "geocentric", "cloud.toml")
        self.assert_error(swath("view", tile, "--save", tile), 2, tile.name)
        self.assert_error(swath("view", south_up(tile, self.folder / "south.laz"), "--save", self.folder / "x.html"), 2, "axes are westing and southing", "UTM zone")
        self.assert_error(swath("view", self.products, "--save", self.folder / "x.html", "--port", "8000"), 2, "exclude each other")


class Server:
    """swath view as it runs; `address` as it was printed."""

    def __init__(self, *arguments):
        self.process = subprocess.Popen([SWATH, "view", "--quiet", *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.address = None
        for line in self.process.stdout:
            found = re.search(r"http://127\.0\.0\.1:(\d+)/", line)
            if found:
                self.address, self.port = found[0], int(found[1])
                break

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.communicate()

    def get(self, path, method="GET", **headers):
        c = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        c.putrequest(method, path, skip_host="Host" in headers)
        for name, value in headers.items():
            c.putheader(name, value)
        c.endheaders()
        r = c.getresponse()
        out = r.status, r.read(), dict(r.getheaders())
        c.close()
        return out


class Serves(Pages):
    def test_files_by_ranges_and_nothing_beyond_the_folder(self):
        secret = self.class_folder / "secret.txt"
        secret.write_text("secret")
        (self.products / ".hidden").write_text("secret")
        (self.products / "link.txt").unlink(missing_ok=True)
        (self.products / "link.txt").symlink_to(secret)
        report = (self.products / "report.json").read_bytes()
        with Server(self.products) as s:
            self.assertEqual(s.get("/")[0], 200)
            self.assertEqual(s.get("/files/report.json")[:2], (200, report))
            status, body, headers = s.get("/files/report.json", Range="bytes=10-29")
            self.assertEqual((status, body, headers["Content-Range"]), (206, report[10:30], f"bytes 10-29/{len(report)}"))
            self.assertEqual(s.get("/files/report.json", Range="bytes=-5")[:2], (206, report[-5:]))
            self.assertEqual(s.get("/files/report.json", method="HEAD")[:2], (200, b""))
            for path in ("/files/../secret.txt", "/files/%2e%2e/secret.txt", "/files/..%2fsecret.txt", "/files/points/../../secret.txt", "/files//etc/passwd",
                         "/files/%2fetc/passwd", "/files/link.txt", "/files/.hidden", "/files/points", "/files/nothing.txt", "/files/report.json%00.txt", "/files/", "/secret.txt",
                         "/cloud/0", "/cloud/99999", "/scene/nothing", "/files/..\\secret.txt"):
                status, body, _ = s.get(path)
                self.assertEqual(status, 404, path)
                self.assertNotIn(b"secret", body, path)
            for method in ("POST", "PUT", "DELETE"):
                self.assertEqual(s.get("/files/report.json", method=method, **{"Content-Length": "0"})[0], 404)

    def test_requests_under_another_name_are_refused(self):
        with Server(self.products) as s:
            for host, status in ((f"127.0.0.1:{s.port}", 200), (f"localhost:{s.port}", 200), ("evil.example", 403), (f"evil.example:{s.port}", 403), ("127.0.0.1", 403),
                                 ("", 403)):
                self.assertEqual(s.get("/", Host=host)[0], status, host)
                self.assertEqual(s.get("/files/report.json", Host=host)[0], status, host)

    def test_other_machines_cannot_ask(self):
        with Server(self.products) as s:
            with open("/proc/net/tcp") as table:
                listening = [line.split()[1] for line in table if line.split()[3] == "0A"]
            self.assertIn(f"0100007F:{s.port:04X}", listening)
            self.assertNotIn(f"00000000:{s.port:04X}", listening)

    def test_ports(self):
        with Server(self.products) as first, Server(self.products) as second:
            self.assertNotEqual(first.port, second.port)
            self.assertEqual(second.get("/")[0], 200)
            self.assert_error(swath("view", self.products, "--quiet", "--port", first.port), 2, "in use", "hint")
        with socket.socket() as other:
            other.bind(("127.0.0.1", 0))
            other.listen()
            self.assert_error(swath("view", self.products, "--quiet", "--port", other.getsockname()[1]), 2, "in use", "hint")
        self.assert_error(swath("view", self.products, "--port", "70000"), 2, "70000")

    def test_ctrl_c_ends_it(self):
        for sent in (signal.SIGINT, signal.SIGTERM):
            with Server(self.products) as s:
                idle = socket.create_connection(("127.0.0.1", s.port))
                self.assertEqual(s.get("/")[0], 200)
                s.process.send_signal(sent)
                self.assertEqual(s.process.wait(15), 0)
                idle.close()
                self.assertEqual(s.process.stderr.read(), "")

    def test_the_page_of_the_server(self):
        with Server(self.products) as s, self.browser() as b:
            self.assertEqual(b.open(s.address), "ready")
            self.assertEqual(b.console, [])
            self.assertGreater(b.value(DRAWN)["share"], 0.2)
            self.assertTrue(all(r.startswith((s.address, "data:", "blob:")) for r in b.requests), b.requests)

    def test_copc_comes_as_it_is_needed(self):
        survey = self.folder / "cloud.toml"
        tiles = "".join(f'\n[[points]]\nfile = "{t}"\n' for t in sorted((self.products / "points").glob("*.laz")))
        survey.write_text(f'name = "copc"\n{tiles}')
        done = swath("run", COPC, "--survey", survey, "--output", self.out, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        with Server(self.out) as s, self.browser() as b:
            self.assertEqual(b.open(s.address), "ready")
            b.wait("swathView.octrees.idle && swathView.octrees.loaded.size > 0")
            self.assertEqual(b.console, [])
            self.assertEqual(b.value("swathView.cloud.size"), b.value("swathView.scene.points.of"))
            self.assertGreater(b.value(DRAWN)["share"], 0.15)
            # Scaled sigmas are as small as they are: a reader that takes their scale for a big-endian number has nonsense.
            sigma = b.value("(() => { const v = Array.from(swathView.cloud.chunks[0].columns.sigma_v).sort((a, b) => a - b); return v[v.length >> 1]; })()")
            self.assertTrue(5 <= sigma <= 300, sigma)
            times = b.value("(() => { const t = swathView.cloud.chunks[0].columns.gps_time; return [Math.min(...t.slice(0, 999)), Math.max(...t.slice(0, 999))]; })()")
            self.assertLess(times[1] - times[0], 3600)


if __name__ == "__main__":
    result = unittest.main(exit=False).result
    nothing_ran = len(result.skipped) > 0 and (result.testsRun == 0 or len(result.skipped) == result.testsRun)
    sys.exit(SKIPPED if nothing_ran else not result.wasSuccessful())
