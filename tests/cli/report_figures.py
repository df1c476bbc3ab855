# SPDX-License-Identifier: GPL-3.0-or-later
"""Every figure of a calibration's report.html, computed again from the files beside it.

  python3 report_figures.py FOLDER     prints what does not agree; exit code 1 where something does not.
Height differences need SWATH_RASTER_VALUES, the program of the tests that reads a GeoTIFF.
"""
import csv
import json
import math
import os
import re
import struct
import subprocess
import sys
from pathlib import Path

from report_page import MISSING, Page, agrees, number

ARC_SECOND = math.radians(1 / 3600)


def rows_of(file):
    with open(file, newline="") as text:
        return list(csv.DictReader(text))


def raster(file):
    done = subprocess.run([os.environ["SWATH_RASTER_VALUES"], str(file)], capture_output=True, check=True, timeout=120)
    nx, ny = struct.unpack_from("<ii", done.stdout)
    return [v for v in struct.unpack_from(f"<{nx * ny}d", done.stdout, 40) if v == v]


def quantile(values, share):
    values = sorted(values)
    at = share * (len(values) - 1)
    k = min(int(at), len(values) - 2)
    return values[0] if len(values) == 1 else values[k] + (at - k) * (values[k + 1] - values[k])


def mean(values):
    return sum(values) / len(values) if values else None


def rms(values):
    return math.sqrt(sum(v * v for v in values) / len(values)) if values else None


def times(v, factor):
    return None if v is None else v * factor


class Report:
    """What each table of the page should hold, from the files."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.tree = json.loads((self.folder / "calibration.json").read_text())
        self.groups = rows_of(self.folder / "residuals.csv")
        self.planes = rows_of(self.folder / "planes.csv")
        self.corrections = rows_of(self.folder / "corrections.csv")
        self.sections = rows_of(self.folder / "sections.csv")
        self.name = {e["parameter"]: e["name"] for e in self.tree["estimates"]}

    # --- estimates

    def findings(self, _):
        for f in self.tree["findings"]:
            names = [self.name[p] for p in f["parameters"]]
            text = " and ".join(filter(None, [", ".join(names[:-1]), names[-1]])) if names else ""
            yield [f["what"], f["cure"], text, "not delivered" if f["refuses"] else "warning"]

    def values(self, parameters, size, change, origin=0.0):
        def rows(_):
            for e in self.tree["estimates"]:
                if e["parameter"] not in parameters or not e["estimated"]:
                    continue
                at = lambda v: times(None if v is None else v - origin, 1 / size)
                known = e["delivered"] or (e["found_sigma"] or 0.0) > 0.0  # what was found is shown though it is not delivered
                value, sigma = (e["value"], e["sigma"]) if e["delivered"] else (e["found"], e["found_sigma"])
                outcome = "delivered, coarse" if e["grade"] == "coarse" else "delivered"
                if not e["delivered"]:
                    outcome = "not settled" if e["grade"] == "unsettled" else "not determined"
                shown = lambda v, by: times(v if known else None, by)
                yield [e["name"], at(e["nominal"]), at(value if known else None), shown(value - e["nominal"], 1 / change), shown(sigma, 1 / change),
                       *(shown(e[k], 1 / change) for k in ("formal", "jackknife_lines", "jackknife_planes", "white")),
                       shown(e["determined"], 100), outcome]
        return rows

    def origin(self, _):
        flown = self.tree["flown"]
        rows = [["made by", self.tree["program"]], ["flown (UTC)", f"{flown['from']} to {flown['to']}" if flown["from"] else ""],
                ["CRS", self.tree["crs"]], *(["input", i] for i in self.tree["inputs"])]
        yield from (row for row in rows if row[1])

    def adjustment(self, _):
        a = self.tree["adjustment"]
        yield from (["observations", a["observations"]], ["unknowns", a["unknowns"]], ["sigma of unit weight", a["sigma0"]],
                    ["condition number of the scaled normal matrix", a["condition"]], ["iterations", a["iterations"]],
                    ["returns taken out", a["rejected_returns"]])

    def components(self, _):
        for c in self.tree["variance_components"]:
            angle = "angle" in c["name"] or "attitude" in c["name"]
            yield [c["name"], c["stated"] / (ARC_SECOND if angle else 0.01), "arcsec" if angle else "cm", c["factor"], c["redundancy"],
                   "estimated" if c["estimated"] else "kept as stated"]

    def readings(self, _):
        estimates = {e["parameter"]: e for e in self.tree["estimates"]}
        for r in self.tree["readings"]:
            e = estimates[r["parameter"]]
            unit, size, origin = {"rad": ("arcsec", ARC_SECOND, 0), "m": ("mm", 1e-3, 0), "s": ("ms", 1e-3, 0), "1": ("ppm", 1e-6, 1)}[e["unit"]]
            row = [e["name"], unit, None, (r["value"] - origin) / size, None, None, r["readings"], MISSING, r["note"]]
            if e["delivered"]:
                difference, joint = r["value"] - e["value"], math.hypot(r["sigma"], e["sigma"])
                row[2], row[4], row[5] = (e["value"] - origin) / size, difference / size, joint / size
                row[7] = "yes" if abs(difference) <= 2 * joint else "no"
            yield row

    # --- the flat target

    TARGET_ANGLES = ("roll", "pitch", "heading")

    def target(self):
        return self.tree.get("flat_target") or {}

    def target_angles(self, _):
        for name in self.TARGET_ANGLES:
            a = self.target().get(name)
            if a is None:
                continue
            outcome = "within the tolerance: present value kept"
            if a.get("beyond_tolerance"):
                outcome = "beyond the tolerance: new value"
            if not a["determined"]:
                outcome = "not determined"
            keys = ("present_deg", "mean_deg", "sigma_arcsec", "sigma_by_scatter_arcsec", "tolerance_arcsec")
            yield [name, *(a.get(k) for k in keys), len(a.get("readings", [])), outcome]

    def target_readings(self, _):
        for name in (*self.TARGET_ANGLES, "range_offset"):
            value, sigma = ("m", "m") if name == "range_offset" else ("deg", "arcsec")
            for r in self.target().get(name, {}).get("readings", []):
                yield [name.replace("_", " "), " and ".join(map(str, r["lines"])), r["value_" + value], value, r["sigma_" + sigma], sigma]

    def target_lines(self, _):
        for l in self.target().get("lines", []):
            views = [l["before"].get(k) for k in ("along_m", "across_m", "up_m")] + [l["after"].get(k) for k in ("along_m", "across_m", "up_m")]
            yield [l["line"], l.get("role", MISSING), l.get("heading_deg"), l.get("height_m"), l.get("scan_angle_deg"), l["before"].get("pulses"),
                   *views, *(l.get(k) for k in ("along_sigma_m", "across_sigma_m", "up_sigma_m"))]

    # --- the flight

    def seen(self, line):
        return {g["plane"] for g in self.groups if int(g["line"]) == line}

    def lines(self, _):
        for l in self.tree["flight"]["lines"]:
            yield [l["id"], l["name"], times(l["heading"], 180 / math.pi), l["height"], l["speed"], l["length"],
                   l["first"] - self.tree["residuals"]["first_time"], l["last"] - l["first"], l["returns"], len(self.seen(l["id"]))]

    def overlaps(self, _):
        lines = self.tree["flight"]["lines"]
        for k, a in enumerate(lines):
            for b in lines[k + 1:]:
                common = len(self.seen(a["id"]) & self.seen(b["id"]))
                if common:
                    known = a["heading"] is not None and b["heading"] is not None
                    turn = math.degrees(abs(math.remainder(b["heading"] - a["heading"], 2 * math.pi))) if known else None
                    yield [a["id"], b["id"], turn, common]

    def plane_kinds(self, _):
        for kind in ("ground", "roof", "wall", "target"):
            of_kind = [p for p in self.planes if p["kind"] == kind]
            yield [kind, len(of_kind), sum(int(p["control_points"]) > 0 for p in of_kind)]

    # --- residuals

    @staticmethod
    def measures(groups):
        used = [g for g in groups if g["rejected"] == "0"]
        returns = sum(int(g["returns"]) for g in used)
        before = [float(g["before_m"]) for g in used if g["before_m"]]
        after = [float(g["after_m"]) for g in used]
        squares = sum(int(g["returns"]) * float(g["rms_m"]) ** 2 for g in used)
        return [len(used), len(groups) - len(used), returns, *(times(v, 100) for v in (mean(before), rms(before), mean(after), rms(after))),
                100 * math.sqrt(squares / returns) if returns else None, max((abs(float(g["w"])) for g in used), default=None)]

    def residuals(self, _):
        yield self.measures(self.groups)

    def by_line(self, _):
        for line in sorted({int(g["line"]) for g in self.groups}):
            yield [line, *self.measures([g for g in self.groups if int(g["line"]) == line])]

    def by(self, column):
        """The bins as the page shows them; together they must hold every group."""
        def rows(shown):
            held = 0
            for row in shown:
                low, high = number(row[0])[0], number(row[1])[0]
                groups = [g for g in self.groups if low <= float(g[column]) < high]
                held += len(groups)
                yield [low, high, *self.measures(groups)]
            if held != len(self.groups):
                yield [f"{len(self.groups) - held} groups are in no bin"]
        return rows

    def outliers(self, _):
        out = [g for g in self.groups if g["rejected"] == "1"]
        out.sort(key=lambda g: -abs(float(g["w"])))
        for g in out[:40]:
            before = float(g["before_m"]) * 100 if g["before_m"] else None
            yield [int(g["plane"]), g["kind"], int(g["line"]), int(g["returns"]), float(g["time_s"]), float(g["scan_angle_deg"]),
                   float(g["range_m"]), before, 100 * float(g["after_m"]), float(g["redundancy"]), float(g["w"])]

    def control(self, _):
        for c in self.tree["control"]:
            yield [c["name"], c["plane"], 100 * c["residual"], 100 * c["sigma"], c["redundancy"], c["w"],
                   "taken out" if c["rejected"] else "used"]

    def checks(self, _):
        for c in self.tree["checks"]:
            yield [c["name"], 100 * c["residual"], 100 * c["sigma"], c["w"]]

    # --- lines against one another

    def line_corrections(self, _):
        for line in dict.fromkeys(c["line"] for c in self.corrections):
            knots = [c for c in self.corrections if c["line"] == line]
            largest = lambda name: max((float(k[name]) for k in knots), key=abs)
            yield [int(line), len(knots), *(100 * largest(f"{n}_m") for n in ("north", "east", "down")),
                   *(largest(f"{n}_rad") / ARC_SECOND for n in ("roll", "pitch", "heading"))]

    def section_list(self, _):
        for k, s in enumerate(self.tree["sections"]):
            rows = [r for r in self.sections if int(r["section"]) == k]
            after = [r for r in rows if r["state"] == "after"]
            yield [s["name"], s["width"], math.dist(*s["ends"]), len({r["line"] for r in after}), len(rows) - len(after), len(after)]

    def differences(self, _):
        for d in self.tree["differences"]:
            row = list(d["lines"])
            for state in ("before", "after"):
                values = [v * d[state]["metres_per_unit"] for v in raster(self.folder / d[state]["file"])]
                row += [len(values), times(mean(values), 100), times(rms(values), 100),
                        100 * quantile([abs(v) for v in values], 0.95) if values else None]
            yield row

    def tables(self):
        angles = {"boresight_roll", "boresight_pitch", "boresight_heading", "scan_offset"}
        lengths = {"range_offset", "lever_forward", "lever_right", "lever_down"}
        out = {"findings": self.findings, "origin": self.origin, "values-angles": self.values(angles, math.radians(1), ARC_SECOND),
               "values-lengths": self.values(lengths, 1.0, 1e-3),
               "values-scales": self.values({"range_scale", "scan_scale"}, 1e-6, 1e-6, 1.0), "values-time": self.values({"latency"}, 1e-3, 1e-3),
               "adjustment": self.adjustment, "components": self.components, "readings": self.readings, "lines": self.lines,
               "overlaps": self.overlaps, "planes": self.plane_kinds, "residuals": self.residuals, "residuals-by-line": self.by_line,
               "residuals-by-angle": self.by("scan_angle_deg"), "residuals-by-range": self.by("range_m"),
               "residuals-by-time": self.by("time_s"), "outliers": self.outliers, "control": self.control, "checks": self.checks,
               "corrections": self.line_corrections, "sections": self.section_list, "differences": self.differences}
        out |= {"target-angles": self.target_angles, "target-readings": self.target_readings, "target-lines": self.target_lines}
        return out


def quantity(text):
    """A value of a config, SI."""
    if not isinstance(text, str):
        return text
    value, unit = text.split()
    return float(value) * {"deg": math.radians(1), "m": 1.0, "s": 1.0}[unit]


def check_delivered(report):
    """The values that the survey's run reads are those of the estimates."""
    tree = report.tree
    # A value passes through degrees.
    same = lambda a, b: math.isclose(a, b, rel_tol=1e-12, abs_tol=1e-15)
    key = {"boresight_roll": "roll", "boresight_pitch": "pitch", "boresight_heading": "heading"}
    arm = ["lever_forward", "lever_right", "lever_down"]
    for e in tree["estimates"]:
        name = e["parameter"]
        held = tree["calibration"]["lever_arm_scanner"][arm.index(name)] if name in arm else tree["calibration"][key.get(name, name)]
        if not same(quantity(held), e["value"] if e["delivered"] else e["nominal"]):
            yield f"calibration.json: {name} is {held}, which is not the delivered value"
        if e["delivered"] and name not in arm and not same(quantity(tree["sigma"][key.get(name, name)]), e["sigma"]):
            yield f"calibration.json: sigma of {name} is {tree['sigma'][key.get(name, name)]}, which is not the delivered one"


def check_texts(report, page):
    tree = report.tree
    if page.verdict != tree["verdict"]:
        yield f"the verdict is {page.verdict!r}, in calibration.json {tree['verdict']!r}"
    numbers = set(re.findall(r"\d+(?:\.\d+)?", page.verdict.replace("\u202f", "")))
    known = {n for f in tree["findings"] for n in re.findall(r"\d+(?:\.\d+)?", f["what"] + f["cure"])}
    known |= {str(len(tree["control"])), str(sum(c["rejected"] for c in tree["control"]))}
    for e in tree["estimates"]:
        if e["delivered"]:
            size = {"rad": ARC_SECOND, "1": 1e-6}.get(e["unit"], 1e-3)
            hit = {n for n in numbers if agrees(n, e["sigma"] / size)}
            if tree["calibrated"] and not hit:
                yield f"the verdict does not tell the sigma of {e['name']}"
            known |= hit
    for r in tree["readings"]:  # a flat target that disagrees
        if not r.get("agrees", True):
            unit = next(e["unit"] for e in tree["estimates"] if e["parameter"] == r["parameter"])
            size = {"rad": ARC_SECOND, "1": 1e-6}.get(unit, 1e-3)
            known |= {n for n in numbers if agrees(n, abs(r["difference"]) / size) or agrees(n, abs(r["difference"]) / r["joint_sigma"])}
    for n in numbers - known:
        yield f"the verdict states {n}, which follows from no file"
    for text in page.paragraphs:
        if re.search(r"\d", text) and tree["survey"] not in text:
            yield f"a paragraph states a number that is in no table: {text!r}"
    notes = [i for i in page.items if i in tree["notes"]]
    if notes != tree["notes"]:
        yield "the notes are not those of calibration.json"
    for file in page.codes:
        if not (report.folder / file).is_file():
            yield f"a caption names {file}, which is not there"


def check(folder):
    """Everything of report.html that the files do not bear out."""
    report = Report(folder)
    page = Page((Path(folder) / "report.html").read_text())
    makers = report.tables()
    out = [*check_delivered(report), *check_texts(report, page)]
    for name, (heads, shown) in page.tables.items():
        if name not in makers:
            out.append(f"table {name}: nothing says what it should hold")
            continue
        expected = [list(row) for row in makers[name](shown)]
        if len(expected) != len(shown):
            out.append(f"table {name}: {len(shown)} rows, from the files {len(expected)}")
        for row, want in zip(shown, expected):
            if len(row) != len(want):
                out.append(f"table {name}: row {row} should hold {want}")
                continue
            for head, cell, value in zip(heads, row, want):
                if not agrees(cell, value):
                    out.append(f"table {name}, {row[0]}, {head}: shown {cell}, from the files {value}")
    for name, maker in makers.items():
        if name not in page.tables and list(maker([])) and not name.startswith("residuals-by-"):
            out.append(f"table {name} is missing")
    return out


if __name__ == "__main__":
    faults = check(sys.argv[1])
    print("\n".join(faults) if faults else "every figure agrees with the files")
    sys.exit(1 if faults else 0)
