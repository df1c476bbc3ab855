# SPDX-License-Identifier: GPL-3.0-or-later
"""A model of COLMAP (text) or OpenSfM through `swath block` and out again: the poses of its file, image points made exactly from made points.

    python3 bench/block/models.py build/release/tools/swath DIR    # DIR: cameras.txt and images.txt, or reconstruction.json
"""
import json
import math
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path


def from_quaternion(q):
    n = math.sqrt(sum(c * c for c in q))
    w, x, y, z = (c / n for c in q)
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def from_vector(v):
    angle = math.sqrt(sum(c * c for c in v))
    if angle == 0.0:
        return from_quaternion((1, 0, 0, 0))
    return from_quaternion((math.cos(angle / 2), *(math.sin(angle / 2) * c / angle for c in v)))


def colmap_poses(folder):
    """name -> (numbers as the file has them, rotation, translation)"""
    out = {}
    for line in (folder / "images.txt").read_text().splitlines():
        words = line.split()
        if len(words) >= 10 and not line.startswith("#") and re.fullmatch(r"\d+", words[0]) and re.fullmatch(r"\d+", words[8]):
            q, t = [float(w) for w in words[1:5]], [float(w) for w in words[5:8]]
            sign = 1 if q[0] >= 0 else -1
            out[" ".join(words[9:])] = ([sign * c for c in q] + t, from_quaternion(q), t)
    return out


def opensfm_poses(folder):
    model = json.loads((folder / "reconstruction.json").read_text())[0]
    out = {}
    for name, shot in model["shots"].items():
        R = from_vector(shot["rotation"])
        out[name] = ([c for row in R for c in row] + shot["translation"], R, shot["translation"])
    return out


def camera_of(folder, is_colmap):
    """fx, cx, cy in pixels from the corner, k1, k2, columns, rows"""
    if is_colmap:
        words = next(line for line in (folder / "cameras.txt").read_text().splitlines() if line and not line.startswith("#")).split()
        v = [float(w) for w in words[4:]]
        if words[1] == "PINHOLE":  # fx, fy
            v = [v[0], *v[2:]]
        elif words[1] not in ("SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL"):
            raise SystemExit(f"{words[1]} is not known here")
        return *v[:3], *(v[3:] + [0.0, 0.0])[:2], int(words[2]), int(words[3])
    camera = next(iter(json.loads((folder / "reconstruction.json").read_text())[0]["cameras"].values()))
    side = max(camera["width"], camera["height"])
    return camera["focal"] * side, camera["width"] / 2, camera["height"] / 2, camera.get("k1", 0.0), camera.get("k2", 0.0), camera["width"], camera["height"]


def marks_of(poses, camera, points):
    f, cx, cy, k1, k2, columns, rows = camera
    out = {}
    for name, (_, R, t) in poses.items():
        for p, X in enumerate(points):
            x, y, z = (sum(R[r][k] * X[k] for k in range(3)) + t[r] for r in range(3))
            if z < 0.5:
                continue
            x, y = x / z, y / z
            r2 = x * x + y * y
            radial = 1 + r2 * (k1 + r2 * k2)
            u, v = cx + f * radial * x, cy + f * radial * y
            if 0 < u < columns and 0 < v < rows:
                out.setdefault(p, []).append((name, u, v))
    return {p: m for p, m in out.items() if len(m) >= 3}


def main(program, folder):
    is_colmap = (folder / "images.txt").exists()
    poses, camera = (colmap_poses if is_colmap else opensfm_poses)(folder), camera_of(folder, is_colmap)
    chance = random.Random(1)
    points = []
    for _, R, t in poses.values():  # before each image, 5 to 30 units away
        for _ in range(300):
            d = chance.uniform(5, 30)
            c = (chance.uniform(-0.6, 0.6) * d - t[0], chance.uniform(-0.4, 0.4) * d - t[1], d - t[2])
            points.append([sum(R[k][r] * c[k] for k in range(3)) for r in range(3)])
    marks = marks_of(poses, camera, points)
    seen = {name for m in marks.values() for name, *_ in m}
    f, cx, cy, k1, k2, columns, rows = camera
    with tempfile.TemporaryDirectory() as made:
        out = Path(made)
        number = {p: k + 1 for k, p in enumerate(marks)}
        if is_colmap:
            (out / "model").mkdir()
            (out / "model" / "cameras.txt").write_text((folder / "cameras.txt").read_text())
            lines = [line for line in (folder / "images.txt").read_text().splitlines() if len(line.split()) >= 10 and line.split()[9] in seen]
            on = {n: " ".join(f"{u!r} {v!r} {number[p]}" for p, m in marks.items() for name, u, v in m if name == n) for n in seen}
            (out / "model" / "images.txt").write_text("".join(f"{line}\n{on[line.split()[9]]}\n" for line in lines))
            source = 'file = "model"\nformat = "colmap"\n'
        else:
            side = max(columns, rows)
            model = json.loads((folder / "reconstruction.json").read_text())
            (out / "reconstruction.json").write_text(json.dumps(model))
            tracks = "".join(f"{name}\t{number[p]}\t{k}\t{(u - columns / 2) / side!r}\t{(v - rows / 2) / side!r}\t0.001\t0\t0\t0\n"
                             for p, m in marks.items() for k, (name, u, v) in enumerate(m))
            (out / "tracks.csv").write_text("OPENSFM_TRACKS_VERSION_v2\n" + tracks.replace("\t0\t0\t0\n", "\t0\t0\t0\t-1\t-1\n"))
            source = 'file = "tracks.csv"\nformat = "opensfm"\n'
        (out / "control.csv").write_text("name,x,y,z\n" + "".join(f"{number[p]},{points[p][0]!r},{points[p][1]!r},{points[p][2]!r}\n" for p in marks))
        mm = 0.005  # a pixel
        k = {"k1": k1 / (f * mm) ** 2, "k2": k2 / (f * mm) ** 4}
        (out / "block.toml").write_text(
            f'crs = "local"\n[[camera]]\nname = "camera"\nf = "{f * mm!r} mm"\nx0 = "{(cx - columns / 2) * mm!r} mm"\ny0 = "{(rows / 2 - cy) * mm!r} mm"\n'
            f'k1 = {k["k1"]!r}\nk2 = {k["k2"]!r}\ndistortion = "ideal"\ncolumns = {columns}\nrows = {rows}\npixel = "5 um"\n'
            f'[[image_points]]\n{source}sigma_pixels = 0.1\n[[control]]\nfile = "control.csv"\nsigma_horizontal = "1 mm"\nsigma_vertical = "1 mm"\n'
            "[adjust]\nrobust = false\ncomponents = false\n")
        done = subprocess.run([program, "block", out / "block.toml", "--output", out / "out"], capture_output=True, text=True)
        if done.returncode:
            raise SystemExit(done.stderr)
        again = colmap_poses(out / "out" / "colmap") if is_colmap else opensfm_poses(out / "out" / "opensfm")
    turn = max(abs(a - b) for n in seen for a, b in zip(poses[n][0][:-3], again[n][0][:-3]))
    shift = max(abs(a - b) for n in seen for a, b in zip(poses[n][0][-3:], again[n][0][-3:]))
    print(f"{len(seen)} images of {len(poses)}, {len(marks)} points: {'quaternions' if is_colmap else 'rotation matrices'} differ by {turn:.1e}, translations by {shift:.1e}")


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
