# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference vectors of Ackermann's blocks through the command line: what is computed beside what the vectors hold.

    SWATH_SHARED=DIR python3 bench/block/vectors.py build/release/tools/swath
"""
import csv
import json
import math
import os
import sqlite3
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

SHARED = Path(os.environ.get("SWATH_SHARED", Path(__file__).resolve().parents[3] / "shared"))
PLAIN = "[adjust]\nrobust = false\ncomponents = false\n"


def vector(name):
    return json.loads((SHARED / "vectors" / f"p002_{name}.json").read_text())


def write(folder, head, images, points, control, drift):
    """`images`: rows of name, strip, time, x, y, z and what more `head` names; `control`: kind -> rows. Sigmas: 10 um and 0.3 m."""
    (folder / "images.csv").write_text("name,strip,time,x,y,z" + head + "\n" + "".join(",".join(map(str, r)) + "\n" for r in images))
    (folder / "points.csv").write_text("image,point,x,y\n" + "".join(",".join(map(str, r)) + "\n" for r in points))
    text = f'kind = "block_adjust"\ncrs = "local"\ndrift = "{drift}"\n[images]\nfile = "images.csv"\nsigma_station_h = "30 cm"\nsigma_station_v = "30 cm"\n'
    if head:
        text += 'angles = "omega_phi_kappa"\nnorth = "grid"\nangle_use = "start"\n'
    text += '[[camera]]\nname = "camera"\nf = "150 mm"\ncolumns = 23000\nrows = 23000\npixel = "10 um"\nmount = "0 deg"\n'
    text += '[[image_points]]\nfile = "points.csv"\nunit = "mm"\ny = "up"\norigin = "middle"\nsigma = "10 um"\n'
    for kind, rows in control.items():
        if rows:
            (folder / f"{kind}.csv").write_text("name,x,y,z\n" + "".join(",".join(map(str, r)) + "\n" for r in rows))
            text += f'[[control]]\nfile = "{kind}.csv"\nkind = "{kind}"\nsigma_horizontal = "30 cm"\nsigma_vertical = "30 cm"\n'
    (folder / "block.toml").write_text(text + PLAIN)


def adjust(program, folder):
    done = subprocess.run([program, "block", folder / "block.toml", "--output", folder / "out"], capture_output=True, text=True)
    return done.stderr.strip() if done.returncode else json.loads((folder / "out" / "block.json").read_text())


def rows_of(file):
    with open(file) as f:
        return list(csv.DictReader(line for line in f if not line.startswith("#")))


def points_of(layer):
    out = {}
    for name, geom, *sigmas in sqlite3.connect(layer).execute("select name, geom, sigma_east, sigma_north, sigma_up from points"):
        out[name] = (struct.unpack_from("<3d", geom, len(geom) - 24), sigmas)
    return out


def angles_of(row):
    """omega, phi, kappa of M = Rkappa Rphi Romega, ground to image, from the matrix in the table."""
    R = [[float(row[f"r{b + 1}{a + 1}"]) for b in range(3)] for a in range(3)]
    return math.atan2(-R[2][1], R[2][2]), math.asin(R[2][0]), math.atan2(-R[1][0], R[0][0])


def small_block(program):
    v = vector("small_block")
    images = [(f"i{i}", v["strip"][i] + 1, v["t"][i], *g) for i, g in enumerate(v["gps"])]
    points = [(f"i{i}", f"p{p}", x, y) for i, p, x, y in v["observations_photo_point_x_y_mm"]]
    control = {kind: [(f"p{c['point']}", c["X"], c["Y"], c["Z"]) for c in v["control"] if c["type"] == kind.upper()] for kind in ("xyz", "z")}
    for drift, want in v["expected"].items():
        with tempfile.TemporaryDirectory() as made:
            folder = Path(made)
            write(folder, "", images, points, control, drift)
            found = adjust(program, folder)
            rows, layer = rows_of(folder / "out" / "orientation.csv"), points_of(folder / "out" / "points.gpkg")
        station = max(abs(float(r[axis]) - want["eo"][i][k]) for i, r in enumerate(rows) for k, axis in enumerate("xyz"))
        angle = max(abs((a - b + math.pi) % (2 * math.pi) - math.pi) for i, r in enumerate(rows) for a, b in zip(angles_of(r), want["eo"][i][3:]))
        place = max(abs(layer[f"p{p}"][0][k] - at[k]) for p, at in enumerate(want["points"]) for k in range(3))
        sigma = max(abs(layer[f"p{p}"][1][k] / sd[k] - 1) for p, sd in enumerate(want["sd_points"]) for k in range(3))
        print(f"small block, drift {drift}: points {1e3 * place:.3f} mm, stations {1e3 * station:.3f} mm, angles {angle:.1e} rad, standard deviations {100 * sigma:.3f} %; "
              f"sigma0 {found['sigma0']:.9f}, reference {want['sigma0_ratio']}")


def geometry(program):
    """Exact image points of the geometry as files: Quadro 1 by `swath block`."""
    g, q = vector("geometry"), vector("quadro1")
    ground, straight = g["points"], g["photos_a"]
    crossed = straight + g["photos_b_cross"]
    want = {k: (v["mu_xy"], v["mu_z"]) for k, v in q["cases"].items()}
    no_control = q["extra"]["no_control_no_drift"]
    cases = [(*case, want[case[0]]) for case in (("1_a_nodrift", straight, g["control_a"], "none"), ("2_a_blockdrift", straight, g["control_a"], "block"),
                                                  ("3_a_stripdrift", straight, g["control_a"], "strip"), ("4_b_stripdrift", crossed, g["control_b"], "strip"))]
    cases.append(("no control, no drift", straight, {}, "none", (no_control["mu_xy"], no_control["mu_z"])))
    cases.append(("four corners, strip drift", straight, g["control_b"], "strip", None))
    for name, photos, control, drift, expected in cases:
        marks, count = [], [0] * len(ground)
        for i, (x0, y0, z0, kappa, *_) in enumerate(photos):
            c, s = math.cos(kappa), math.sin(kappa)
            for p, (x, y, z) in enumerate(ground):
                u, v = c * (x - x0) + s * (y - y0), -s * (x - x0) + c * (y - y0)
                u, v = -150 * u / (z - z0), -150 * v / (z - z0)
                if max(abs(u), abs(v)) <= 114 + 1e-9:
                    marks.append((f"i{i}", f"p{p}", u, v))
                    count[p] += 1
        marks = [m for m in marks if count[int(m[1][1:])] > 1]
        images = [(f"i{i}", int(strip) + 1, t, x, y, z, 0, 0, math.degrees(k)) for i, (x, y, z, k, strip, t) in enumerate(photos)]
        surveyed = {kind: [(f"p{p}", *ground[int(p)]) for p, has in control.items() if has == kind.upper()] for kind in ("xyz", "z")}
        with tempfile.TemporaryDirectory() as made:
            write(Path(made), ",omega,phi,kappa", images, marks, surveyed, drift)
            found = adjust(program, Path(made))
        if isinstance(found, str):
            print(f"{name}: {found}")
        else:
            print(f"{name}: mu_xy {found['sigma_plan_m'] / 0.3:.4f}, mu_z {found['sigma_height_m'] / 0.3:.4f}, reference {expected[0]}, {expected[1]}")


def flevoland(program):
    v = vector("flevoland_synthetic")
    with tempfile.TemporaryDirectory() as made:
        table = Path(made) / "differences.csv"
        table.write_text("strip,time,dS\n" + "".join(f"{s['strip']},{t!r},{d!r}\n" for s in v["strips"] for t, d in zip(s["t_s"], s["dS_cm"])))
        found = json.loads(subprocess.run([program, "block-drift", table, "--json"], capture_output=True, text=True, check=True).stdout)[0]
    want = v["expected"]
    pairs = [(found["rms_direct"], want["rms_direct"]), (found["rms_less_strip_means"], want["rms_minus_strip_means"]), (found["rms_less_one_line"], want["rms_one_regression"])]
    print("Flevoland: " + ", ".join(f"{a:.7f} (reference {b})" for a, b in pairs) + f" cm; largest difference {max(abs(a - b) for a, b in pairs):.1e}")


if __name__ == "__main__":
    small_block(sys.argv[1])
    geometry(sys.argv[1])
    flevoland(sys.argv[1])
