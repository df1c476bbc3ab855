# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks of images with known truth, written as files for `swath block`: strips, a camera with Brown distortion, noise, stations with shift
and drift, control and check points. Independent of the program's own projection.

    python3 bench/block/blocks.py calibration build/release/tools/swath   # 22 images, three crossing strips: sigmas of the camera
    python3 bench/block/blocks.py control build/release/tools/swath       # 60 images, 8, 3 and 0 control points: check points
    python3 bench/block/blocks.py seeds build/release/tools/swath         # 20 seeds: errors over standard deviations
    python3 bench/block/blocks.py size build/release/tools/swath          # 10 000 images, a million image points: time and memory
    python3 bench/block/blocks.py size build/release/tools/swath 100 100 10   # the same, stations correlated with 10 before each
"""
import csv
import json
import math
import random
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

KEYS = ["f", "x0", "y0", "k1", "k2", "k3", "p1", "p2", "b1", "b2"]


class Camera:
    """mm; distortion of the ideal point."""

    def __init__(self, f=50.0, columns=7216, rows=5412, pixel=0.0068, **values):
        self.columns, self.rows, self.pixel = columns, rows, pixel
        self.value = {"f": f, **{k: 0.0 for k in KEYS[1:]}, **values}

    def project(self, d):
        v = self.value
        if d[2] >= -1e-9:
            return None
        x, y = -v["f"] * d[0] / d[2], -v["f"] * d[1] / d[2]
        half = (self.columns * self.pixel / 2, self.rows * self.pixel / 2)
        if abs(x) > 1.2 * half[0] or abs(y) > 1.2 * half[1]:  # the polynomial may fold far outside
            return None
        r2 = x * x + y * y
        radial = r2 * (v["k1"] + r2 * (v["k2"] + r2 * v["k3"]))
        u = v["x0"] + x + x * radial + v["p1"] * (r2 + 2 * x * x) + 2 * v["p2"] * x * y + v["b1"] * x + v["b2"] * y
        w = v["y0"] + y + y * radial + v["p2"] * (r2 + 2 * y * y) + 2 * v["p1"] * x * y
        return (u, w) if abs(u) < half[0] and abs(w) < half[1] else None


def times(A, B):
    return [[sum(A[i][k] * B[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def turn(axis, a):
    c, s = math.cos(a), math.sin(a)
    return {0: [[1, 0, 0], [0, c, -s], [0, s, c]], 1: [[c, 0, s], [0, 1, 0], [-s, 0, c]], 2: [[c, -s, 0], [s, c, 0], [0, 0, 1]]}[axis]


class Block:
    """East, north, up. `strips`: (x, y, heading deg, images, base, height) of the first image. `across`: the long side of the sensor lies
    across the direction of flight, as survey cameras are mounted; otherwise along it."""

    def __init__(self, seed, camera, strips, relief=60.0, tilt=2.0, interval=10.0, across=False):
        self.random, self.camera, self.across = random.Random(seed), camera, across
        self.images, self.points, self.relief = [], {}, relief
        for number, (x, y, heading, images, base, height) in enumerate(strips, 1):
            h = math.radians(heading)
            for k in range(images):
                at = [x + k * base * math.sin(h), y + k * base * math.cos(h), height]
                at = [c + self.random.gauss(0, 0.01 * base) for c in at]
                roll, pitch = (math.radians(self.random.gauss(0, tilt)) for _ in range(2))
                crab = h + math.radians(self.random.gauss(0, tilt))
                ned_R_body = times(turn(2, crab), times(turn(1, pitch), turn(0, roll)))
                self.images.append({"name": f"s{number}_{k + 1}", "strip": number, "time": 1000.0 * number + interval * k, "at": at, "body": ned_R_body})

    def grid(self, spacing, margin):
        xs, ys = [i["at"][0] for i in self.images], [i["at"][1] for i in self.images]
        x = min(xs) - margin
        n = 0
        while x <= max(xs) + margin:
            y = min(ys) - margin
            while y <= max(ys) + margin:
                n += 1
                px, py = x + self.random.uniform(-0.3, 0.3) * spacing, y + self.random.uniform(-0.3, 0.3) * spacing
                self.points[f"t{n}"] = [px, py, self.relief * math.sin(px / 173.0) * math.cos(py / 219.0)]
                y += spacing
            x += spacing

    def add(self, name, x, y):
        self.points[name] = [x, y, self.relief * math.sin(x / 173.0) * math.cos(y / 219.0)]

    def marks(self, noise):
        """(image, point, x, y): camera x forward, y left, z up of the body (mount 0), or x right, y forward (mount 90 deg)."""
        out = []
        reach = 1.2 * max(self.camera.columns, self.camera.rows) * self.camera.pixel / self.camera.value["f"]
        cells = {}
        side = 0.5 * reach * max(i["at"][2] for i in self.images)
        for name, p in self.points.items():
            cells.setdefault((int(p[0] // side), int(p[1] // side)), []).append((name, p))
        for image in self.images:
            B, at = image["body"], image["at"]
            cx, cy = int(at[0] // side), int(at[1] // side)
            span = range(-3, 4)
            for name, p in (q for a in span for b in span for q in cells.get((cx + a, cy + b), ())):
                e, n, u = (p[k] - at[k] for k in range(3))
                ned = (n, e, -u)
                body = [sum(B[k][j] * ned[k] for k in range(3)) for j in range(3)]
                seen = self.camera.project((body[1], body[0], -body[2]) if self.across else (body[0], -body[1], -body[2]))
                if seen:
                    out.append((image["name"], name, seen[0] + self.random.gauss(0, noise), seen[1] + self.random.gauss(0, noise)))
        return out

    def write(self, folder, noise, free=(), stations=None, shift=0.0, drift=0.0, angles=None, boresight=(0.0, 0.0, 0.0), control=None, check=None, sigma_control=0.02, sigma_check=0.0,
              sets="none", start=None, antenna=(0.0, 0.0, 0.0), more=""):
        """`stations`, `angles`: sigmas (m, deg) of what is observed. Returns the truth of shifts and drifts by strip."""
        g = self.random.gauss
        truth, count = {}, {}
        marks = self.marks(noise)
        for m in marks:
            count[m[1]] = count.get(m[1], 0) + 1
        first = {s: min(i["time"] for i in self.images if i["strip"] == s) for s in {i["strip"] for i in self.images}}
        last = {s: max(i["time"] for i in self.images if i["strip"] == s) for s in first}
        for s in first:
            truth[s] = ([g(0, shift) for _ in range(3)], [g(0, drift) for _ in range(3)])
        with open(folder / "images.csv", "w") as f:
            f.write("name,strip,time,x,y,z" + (",roll,pitch,heading" if angles else "") + "\n")
            mounted = times(turn(2, boresight[2]), times(turn(1, boresight[1]), turn(0, boresight[0])))  # body_R_camera body
            for i in self.images:
                s = i["strip"]
                u = (i["time"] - first[s]) / (last[s] - first[s])
                camera_body = i["body"]
                body = times(camera_body, [[mounted[c][r] for c in range(3)] for r in range(3)])
                arm = [sum(body[r][k] * antenna[k] for k in range(3)) for r in range(3)]
                arm = (arm[1], arm[0], -arm[2])
                at = [i["at"][k] + arm[k] + truth[s][0][k] + u * truth[s][1][k] + g(0, stations or 0.5) for k in range(3)]
                row = [i["name"], s, i["time"], *(f"{c:.6f}" for c in at)]
                if angles:
                    small = times(turn(2, math.radians(g(0, angles))), times(turn(1, math.radians(g(0, angles))), turn(0, math.radians(g(0, angles)))))
                    R = times(body, small)
                    row += [f"{math.degrees(a):.9f}" for a in (math.atan2(R[2][1], R[2][2]), -math.asin(R[2][0]), math.atan2(R[1][0], R[0][0]))]
                f.write(",".join(map(str, row)) + "\n")
        with open(folder / "points.csv", "w") as f:
            f.write("image,point,x,y\n")
            f.writelines(f"{i},{p},{x:.7f},{y:.7f}\n" for i, p, x, y in marks if count[p] > 1)
        for name, names, sigma in (("control", control, sigma_control), ("check", check, sigma_check)):
            if names:
                rows = [",".join([n, *(f"{c + g(0, sigma):.5f}" for c in self.points[n])]) for n in names]
                (folder / f"{name}.csv").write_text("name,x,y,z\n" + "\n".join(rows) + "\n")
        k, guess = self.camera, dict(start or {})
        values = {n: guess.get(n, 0.0 if n in free and n != "f" else k.value[n]) for n in KEYS}
        sigma = ", ".join([f'{n} = "free"' for n in free if n in KEYS] + [f'{n} = "free"' for n in free if n not in KEYS])
        text = f'kind = "block_adjust"\ncrs = "local"\ndrift = "{sets}"\n[images]\nfile = "images.csv"\n'
        text += f'stations = "{"observed" if stations else "start"}"\nsigma_station_h = "{stations or 1} m"\nsigma_station_v = "{stations or 1} m"\n'
        if angles:
            text += f'angles = "roll_pitch_heading"\nnorth = "grid"\nangle_use = "observed"\nsigma_angle = "{angles} deg"\nsigma_heading = "{angles} deg"\n'
        text += f'[[camera]]\nname = "C"\nf = "{values["f"]} mm"\nx0 = "{values["x0"]} mm"\ny0 = "{values["y0"]} mm"\n'
        text += 'mount = "90 deg"\n' if self.across else ""
        text += "".join(f"{n} = {values[n]}\n" for n in KEYS[3:]) + f'distortion = "ideal"\ncolumns = {k.columns}\nrows = {k.rows}\npixel = "{1000 * k.pixel} um"\n'
        text += f'antenna = ["{antenna[0]} m", "{antenna[1]} m", "{antenna[2]} m"]\n' + (f"sigma = {{ {sigma} }}\n" if free else "")
        text += f'[[image_points]]\nfile = "points.csv"\nunit = "mm"\ny = "up"\norigin = "middle"\nsigma = "{1000 * noise} um"\n'
        if control:
            text += f'[[control]]\nfile = "control.csv"\nsigma_horizontal = "{sigma_control} m"\nsigma_vertical = "{sigma_control} m"\n'
        if check:
            text += f'[[control]]\nfile = "check.csv"\nuse = "check"\nsigma_horizontal = "{sigma_check or 0.001} m"\nsigma_vertical = "{sigma_check or 0.001} m"\n'
        (folder / "block.toml").write_text(text + more)
        return truth


def adjust(program, folder, *sets):
    done = subprocess.run([program, "block", folder / "block.toml", "--output", folder / "out", *(w for s in sets for w in ("--set", s))], capture_output=True, text=True)
    if done.returncode:
        return done.stderr.strip()
    return json.loads((folder / "out" / "block.json").read_text())


def camera_sigmas(found):
    return {v["name"]: v["sigma"] for v in found["cameras"][0]["values"] if not v["held"]}


PLAIN = ("adjust.robust=false", "adjust.components=false")
TRUE = {"x0": 0.021, "y0": -0.034, "k1": -2.1e-5, "k2": 1.2e-8, "k3": -2e-12, "p1": 3e-6, "p2": -4e-6}


def calibration(program, height=900.0, f=50.0, spacing=0.3, stations=0.25, noise=0.33, relief=16.0):
    """22 images in two parallel strips and one across, 9 control points, overlaps 60 and 30 %."""
    camera = Camera(f, **TRUE)
    base, apart = 0.4 * height * camera.rows * camera.pixel / f, 0.7 * height * camera.columns * camera.pixel / f
    long = 7 * base
    strips = [(0, 0, 90, 8, base, height), (long, apart, 270, 8, base, height), (long / 2, apart / 2 - 2.5 * base, 0, 6, base, height)]
    free = ("f", "x0", "y0", "k1", "k2", "k3", "p1", "p2")
    for name, drop, observed in (("with stations", 0, stations), ("without stations", 0, None), ("without the cross strip", 1, stations)):
        with tempfile.TemporaryDirectory() as made:
            block = Block(1, camera, strips[: 3 - drop], relief, across=True)
            block.grid(spacing * base, 0.5 * base)
            names = []
            for a in range(3):
                for b in range(3):
                    names.append(f"c{a}{b}")
                    block.add(names[-1], long * a / 2, apart * b / 2)
            block.write(Path(made), noise * camera.pixel, free, stations=observed, control=names, sigma_control=0.1)
            found = adjust(program, Path(made), *PLAIN)
            if isinstance(found, str):
                print(name, found)
                continue
            s = camera_sigmas(found)
            print(f"{name}: {found['image_points'] / found['images']:.0f} points an image, GSD {found['gsd_m']:.3f} m; sigma um f {1e3 * s['f']:.1f} x0 {1e3 * s['x0']:.1f} "
                  f"y0 {1e3 * s['y0']:.1f}; k1 {s['k1']:.2e} k2 {s['k2']:.2e} k3 {s['k3']:.2e} p1 {s['p1']:.2e} p2 {s['p2']:.2e}")
            for note in found["findings"]:
                print("   note:", note)


def control(program, height=900.0, f=50.0, noise=0.37, stations=0.2, surveyed=0.05, seeds=60):
    """60 images in four strips, overlaps 60 and 20 %; 8, 3 and no control points; root mean square of 20 check points, surveyed as control
    is, over seeds."""
    camera = Camera(f)
    base, apart = 0.4 * height * camera.rows * camera.pixel / f, 0.8 * height * camera.columns * camera.pixel / f
    strips = [(0 if k % 2 == 0 else 14 * base, k * apart, 90 if k % 2 == 0 else 270, 15, base, height) for k in range(4)]
    for count in (8, 3, 0):
        squares = [[], [], []]
        for seed in range(1, seeds + 1):
            with tempfile.TemporaryDirectory() as made:
                block = Block(seed, camera, strips, across=True)
                block.grid(0.35 * base, 0.4 * base)
                places = [(0, 0), (14, 0), (0, 3), (14, 3), (7, 0), (7, 3), (0, 1.5), (14, 1.5)]
                names, check = [], []
                for k, (a, b) in enumerate(places):
                    names.append(f"c{k}")
                    block.add(names[-1], a * base, b * apart)
                for k in range(20):
                    check.append(f"q{k}")
                    block.add(check[-1], block.random.uniform(0, 14) * base, block.random.uniform(0, 3) * apart)
                used = {8: names, 3: [names[0], names[1], names[5]], 0: None}[count]
                block.write(Path(made), noise * camera.pixel, stations=stations, control=used, check=check, sigma_control=surveyed, sigma_check=surveyed)
                found = adjust(program, Path(made), *PLAIN)
                if isinstance(found, str):
                    print(count, seed, found)
                    continue
                for k, c in enumerate(found["check"]):
                    squares[k].append(c["rms_m"] ** 2)
        rms = [math.sqrt(sum(s) / len(s)) for s in squares]
        print(f"{count} control points, GSD {found['gsd_m']:.3f} m: check points X {rms[0]:.3f} Y {rms[1]:.3f} Z {rms[2]:.3f} m")


def seeds(program, number=20):
    """Errors over standard deviations: points, stations, camera, boresight, shifts and drifts."""
    sums = {}

    def note(kind, error, sigma):
        total = sums.setdefault(kind, [0.0, 0])
        total[0] += (error / sigma) ** 2
        total[1] += 1

    free = ("f", "x0", "y0", "k1", "k2", "p1", "p2", "boresight")
    for seed in range(1, number + 1):
        camera = Camera(50.0, **{**TRUE, "k3": 0.0})
        height = 900.0
        base, apart = 0.4 * height * camera.columns * camera.pixel / 50.0, 0.6 * height * camera.rows * camera.pixel / 50.0
        strips = [(0 if k % 2 == 0 else 6 * base, k * apart, 90 if k % 2 == 0 else 270, 7, base, height) for k in range(3)]
        strips += [(a * base, -0.5 * base, 0, 6, 0.35 * apart + 0.2 * base, height) for a in (0.5, 5.5)]
        block = Block(seed, camera, strips)
        block.grid(0.35 * base, 0.4 * base)
        names, check = [], []
        for k, (a, b) in enumerate(((0, 0), (6, 0), (0, 2), (6, 2))):
            names.append(f"c{k}")
            block.add(names[-1], a * base, b * apart)
        for k in range(20):
            check.append(f"q{k}")
            block.add(check[-1], block.random.uniform(0, 6) * base, block.random.uniform(0, 2) * apart)
        with tempfile.TemporaryDirectory() as made:
            bore = (0.004, -0.003, 0.006)
            truth = block.write(Path(made), 0.0027, free, stations=0.08, shift=0.5, drift=0.3, angles=0.008, boresight=bore, control=names, check=check, sigma_control=0.03,
                                sets="strip", start={"f": 50.05}, antenna=(0.2, -0.1, -1.1))
            found = adjust(program, Path(made), *PLAIN)
            if isinstance(found, str):
                print(seed, found)
                continue
            for c in found["check"]:
                sums.setdefault("check points", [0.0, 0])[0] += c["over_sigma"] ** 2 * c["points"]
                sums["check points"][1] += c["points"]
            for v in found["cameras"][0]["values"]:
                if not v["held"] and v["name"] in KEYS:
                    note("camera", v["value"] - camera.value[v["name"]], v["sigma"])
            for name, true in zip(("boresight_roll", "boresight_pitch", "boresight_heading"), bore):
                v = next(x for x in found["cameras"][0]["values"] if x["name"] == name)
                note("boresight", v["value"] - math.degrees(true), v["sigma"])
            for d in found["drifts"]:
                for k in range(3):
                    note("shifts", d["shift_m"][k] - truth[d["strip"]][0][k], d["shift_sigma_m"][k])
                    note("drifts", d["change_m"][k] - truth[d["strip"]][1][k], d["change_sigma_m"][k])
            with open(Path(made) / "out" / "orientation.csv") as f:
                rows = list(csv.DictReader(line for line in f if not line.startswith("#")))
            for row, image in zip(rows, block.images):
                for k, axis in enumerate("xyz"):
                    note("stations", float(row[axis]) - image["at"][k], math.sqrt(float(row[f"c{k + 1}{k + 1}"])))
                R = [[float(row[f"r{a + 1}{b + 1}"]) for b in range(3)] for a in range(3)]
                enu_R_body = [image["body"][1], image["body"][0], [-c for c in image["body"][2]]]
                T = times(enu_R_body, [[1, 0, 0], [0, -1, 0], [0, 0, -1]])
                E = times([[R[b][a] for b in range(3)] for a in range(3)], T)  # camera as found from camera in truth
                for k, e in enumerate(((E[2][1] - E[1][2]) / 2, (E[0][2] - E[2][0]) / 2, (E[1][0] - E[0][1]) / 2)):
                    note("attitudes", e, math.sqrt(float(row[f"c{k + 4}{k + 4}"])))
    for kind, (total, n) in sums.items():
        print(f"{kind}: error over sigma {math.sqrt(total / n):.3f} of {n}")


def correlate(folder, images, paired, sigma, decay=100.0):
    """Stations with errors that decay over time (s), each paired with those before it."""
    with open(folder / "correlation.csv", "w") as f:
        f.write("# crs: local\nimage,other," + ",".join(f"c{r}{c}" for r in range(1, 7) for c in range(1, 7)) + "\n")
        for k, image in enumerate(images):
            for other in images[max(0, k - paired):k + 1]:
                share = math.exp(-abs(image["time"] - other["time"]) / decay)
                entries = [f"{share * (sigma ** 2 if r < 3 else 1e-8):.12e}" if r == c else "0" for r in range(6) for c in range(6)]
                f.write(f"{image['name']},{other['name']},{','.join(entries)}\n")
    config = folder / "block.toml"
    config.write_text(config.read_text().replace("[images]\n", '[images]\ncorrelation = "correlation.csv"\n'))


def size(program, strips=100, images=100, paired=0):
    camera = Camera(50.0)
    height = 900.0
    base, apart = 0.4 * height * camera.columns * camera.pixel / 50.0, 0.7 * height * camera.rows * camera.pixel / 50.0
    layout = [(0 if k % 2 == 0 else (images - 1) * base, k * apart, 90 if k % 2 == 0 else 270, images, base, height) for k in range(strips)]
    block = Block(1, camera, layout)
    block.grid(math.sqrt(apart * base / 28.5), 0.3 * base)
    names = []
    for k, (a, b) in enumerate(((0, 0), (images - 1, 0), (0, strips - 1), (images - 1, strips - 1))):
        names.append(f"c{k}")
        block.add(names[-1], a * base, b * apart)
    with tempfile.TemporaryDirectory() as made:
        block.write(Path(made), 0.0027, stations=0.08, control=names, sigma_control=0.03)
        if paired:
            correlate(Path(made), block.images, paired, 0.08)
        begin = time.monotonic()
        found = adjust(program, Path(made), *PLAIN)
        taken = time.monotonic() - begin
        if isinstance(found, str):
            return print(found)
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        print(f"{found['images']} images, {found['points']} points, {found['image_points']} image points: {taken:.0f} s, "
              f"{used.ru_utime + used.ru_stime:.0f} s of processor time, {used.ru_maxrss / 1e6:.1f} GB; sigma0 {found['sigma0']:.3f}")
        return None


if __name__ == "__main__":
    {"calibration": calibration, "control": control, "seeds": seeds, "size": size}[sys.argv[1]](sys.argv[2], *map(int, sys.argv[3:]))
