# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command-line tests share: the program as a user calls it, small surveys, files to spoil, LAS and rasters read back."""
import json
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SWATH = os.environ["SWATH_PROGRAM"]
RASTER_VALUES = os.environ["SWATH_RASTER_VALUES"]
SOURCE = Path(os.environ["SWATH_SOURCE"])
CONFIG = SOURCE / "configs" / "survey_sbet.toml"  # starts from a given trajectory: most tests' surveys are too short for another
FULL = SOURCE / "configs" / "survey.toml"
CLOUD = SOURCE / "configs" / "cloud.toml"

# One line of 60 m: some 4000 returns.
SMALLEST = ["imu.file=false", "gnss.file=false", "world.scene=flat", "world.length=60 m", "world.width=60 m", "flight.lines=1",
            "flight.cross_lines=0", "flight.height=250 m", "scanner.prf=3 kHz", "mounting.deliver=truth"]
# Two lines over hills: some 19 000 returns.
SMALL = ["imu.file=false", "gnss.file=false", "world.scene=hills", "world.length=160 m", "world.width=120 m", "flight.lines=2",
         "flight.cross_lines=0", "flight.height=250 m", "scanner.prf=3 kHz", "mounting.deliver=truth"]


def swath(*arguments, **keywords):
    return subprocess.run([SWATH, *map(str, arguments)], capture_output=True, text=True, timeout=300, **keywords)


def sets(options):
    return [word for option in options for word in ("--set", option)]


def simulate(folder, options):
    done = swath("simulate", folder, "--quiet", *sets(options))
    if done.returncode != 0:
        raise AssertionError(f"swath simulate failed: {done.stderr}")
    return Path(folder)


def products(folder):
    """Bytes by name of everything a run made; the report tells of times and is left out."""
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(Path(folder).rglob("*"))
            if p.is_file() and p.name != "report.json"}


TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "integer": int, "number": (int, float), "null": type(None)}


def is_of(value, name):
    return isinstance(value, TYPES[name]) and (name == "boolean" or not isinstance(value, bool))


def schema_faults(value, schema, at="report"):
    """What of JSON Schema the value breaks, as far as `swath schema` uses it; and keys of results that it does not declare."""
    if "anyOf" in schema:
        found = [schema_faults(value, one, at) for one in schema["anyOf"]]
        named = [f for f, one in zip(found, schema["anyOf"])
                 if isinstance(value, dict) and one.get("properties", {}).get("type", {}).get("const") == value.get("type")]
        return min(named or found, key=len)
    faults = [f"{at}: {value!r} is not {schema['const']!r}"] if "const" in schema and value != schema["const"] else []
    if "enum" in schema and value not in schema["enum"]:
        faults.append(f"{at}: {value!r} is not in {schema['enum']}")
    if "type" in schema:
        names = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
        if not any(is_of(value, name) for name in names):
            return [*faults, f"{at}: {value!r} is no {names}"]
    if isinstance(value, dict) and schema.get("properties"):  # a stage that declares no findings may have any
        faults += [f"{at}: {key} is not there" for key in schema.get("required", []) if key not in value]
        for key, one in value.items():
            inner = schema["properties"].get(key, schema.get("additionalProperties"))
            if inner is not None:
                faults += schema_faults(one, inner, f"{at}.{key}")
            elif not at.endswith(".tally"):  # readers count what they meet under names that no list has
                faults.append(f"{at}.{key} is not declared")
    if isinstance(value, dict) and isinstance(schema.get("additionalProperties"), dict) and "properties" not in schema:
        for key, one in value.items():
            faults += schema_faults(one, schema["additionalProperties"], f"{at}.{key}")
    if isinstance(value, list) and "items" in schema:
        for k, one in enumerate(value):
            faults += schema_faults(one, schema["items"], f"{at}[{k}]")
    return faults


def stage(report, name):
    return next(s for s in report["stages"] if s["type"] == name)


class Case(unittest.TestCase):
    """A test with a temporary folder, and one survey per class in `cls.survey` where `simulated` names options."""
    simulated = None

    @classmethod
    def setUpClass(cls):
        cls.class_folder = Path(tempfile.mkdtemp(prefix="swath-cli-"))
        if cls.simulated is not None:
            cls.survey = simulate(cls.class_folder / "survey", cls.simulated)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.class_folder, ignore_errors=True)

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="test-", dir=self.class_folder))
        self.out = self.folder / "out"

    def tearDown(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def copy(self):
        """The class's survey, to spoil."""
        return Path(shutil.copytree(self.survey, self.folder / "survey"))

    def run_ok(self, survey, *more, config=CONFIG, out=None, code=0):
        done = swath("run", config, "--survey", survey, "--output", out or self.out, "--quiet", *more)
        self.assertEqual(done.returncode, code, done.stderr)
        if code == 0:
            self.assertEqual(done.stderr, "")
        return json.loads(((out or self.out) / "report.json").read_text())

    def assert_error(self, done, code, *words):
        """Exactly one error, of this code, that holds all the words and a hint."""
        self.assertEqual(done.returncode, code, f"{done.stdout}\n{done.stderr}")
        self.assertTrue(done.stderr.startswith("swath: error: "), done.stderr)
        self.assertEqual(done.stderr.count("error:"), 1, done.stderr)
        self.assertNotIn("terminate", done.stderr)
        self.assertLess(len(done.stderr), 2000)
        for word in words:
            self.assertRegex(done.stderr, word)

    def assert_refused(self, survey, code, *words, config=CONFIG, more=()):
        """A run that ends with one error and leaves nothing behind."""
        done = swath("run", config, "--survey", survey, "--output", self.out, "--quiet", *more)
        self.assert_error(done, code, *words)
        self.assertFalse(self.out.exists(), "the output folder stays behind")
        for file in self.folder.rglob("*"):
            self.assertNotIn(".part", file.name)

    def assert_bad_data(self, survey, *words, **keywords):
        self.assert_refused(survey, 1, *words, "hint: ", **keywords)

    def assert_bad_usage(self, survey, *words, **keywords):
        self.assert_refused(survey, 2, *words, **keywords)


# --- files to spoil

def patch(file, at, data):
    with open(file, "r+b") as f:
        f.seek(at)
        f.write(data)


def truncate(file, size):
    os.truncate(file, size if size >= 0 else os.path.getsize(file) + size)


def substitute(file, old, new):
    text = Path(file).read_text()
    assert old in text, old
    Path(file).write_text(text.replace(old, new, 1))


def edit_line(file, number, column, value):
    """Sets one field of a comma-separated line (from 0)."""
    lines = Path(file).read_text().split("\n")
    fields = lines[number].split(",")
    fields[column] = value
    lines[number] = ",".join(fields)
    Path(file).write_text("\n".join(lines))


def f8(value):
    return struct.pack("<d", value)


NAN, INFINITE = math.nan, math.inf


class Npy:
    """Where the records of a simulated laser.npy stand."""
    FIELDS = {"time": 0, "angle": 10, "range": 18}
    ROW = 30

    def __init__(self, file):
        self.file = file
        head = Path(file).read_bytes()[:4096]
        self.begin = 10 + struct.unpack("<H", head[8:10])[0]
        self.rows = int(re.search(rb"'shape': \((\d+),", head).group(1))
        self.rows_at = re.search(rb"'shape': \((\d+),", head).start(1)

    def set(self, row, field, value):
        patch(self.file, self.begin + row * self.ROW + self.FIELDS[field], f8(value))


# --- LAS

def write_las(file, points, scale=0.001):
    """LAS 1.2, format 1: x y z of each point, one return each, times 0.001 s apart."""
    xs, ys, zs = zip(*points) if points else ((0,), (0,), (0,))
    offset = (math.floor(xs[0]), math.floor(ys[0]), 0.0)
    head = bytearray(227)
    head[0:4] = b"LASF"
    head[24:26] = bytes((1, 2))
    struct.pack_into("<HII", head, 94, 227, 227, 0)
    struct.pack_into("<BHI", head, 104, 1, 28, len(points))
    struct.pack_into("<I", head, 111, len(points))
    struct.pack_into("<6d", head, 131, scale, scale, scale, *offset)
    struct.pack_into("<6d", head, 179, max(xs), min(xs), max(ys), min(ys), max(zs), min(zs))
    body = b"".join(
        struct.pack("<iiiHBBbBHd", round((x - offset[0]) / scale), round((y - offset[1]) / scale), round(z / scale), 100, 0b1001, 0, 0, 0,
                    1, 1000.0 + 0.001 * i) for i, (x, y, z) in enumerate(points))
    Path(file).write_bytes(bytes(head) + body)


def in_crs(file, points, *keys):
    """A cloud whose GeoTIFF keys state its CRS; `keys`: number and value of each."""
    write_las(file, points, scale=0.01)
    data = bytearray(file.read_bytes())
    entries = [v for number, value in keys for v in (number, 0, 1, value)]
    keys = struct.pack(f"<{4 + len(entries)}H", 1, 1, 0, len(entries) // 4, *entries)
    data[227:227] = struct.pack("<H16sHH32s", 0, b"LASF_Projection", 34735, len(keys), b"") + keys
    struct.pack_into("<II", data, 96, 227 + 54 + len(keys), 1)
    file.write_bytes(bytes(data))


SOUTH_UP = ('PROJCS["south up",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],'
            'PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",19],PARAMETER["scale_factor",1],PARAMETER["false_easting",0],'
            'PARAMETER["false_northing",0],UNIT["metre",1],AXIS["Y",WEST],AXIS["X",SOUTH]]').encode()


def south_up(tile, file):
    """The LAZ file in a CRS that no page shows; its points are cut off, so that whoever reads them fails."""
    data = bytearray(tile.read_bytes()[:tile.stat().st_size * 7 // 10])
    at, count = struct.unpack_from("<H", data, 94)[0], struct.unpack_from("<I", data, 100)[0]
    for _ in range(count):
        user, number, length = struct.unpack_from("<16sHH", data, at + 2)
        if user.startswith(b"LASF_Projection") and number == 2112:
            data[at + 54:at + 54 + length] = SOUTH_UP.ljust(length, b"\0")[:length]
        at += 54 + length
    file.write_bytes(bytes(data))
    return file


def las_header(data):
    return {"scale": struct.unpack_from("<3d", data, 131), "offset": struct.unpack_from("<3d", data, 155),
            "format": data[104], "length": struct.unpack_from("<H", data, 105)[0], "begin": struct.unpack_from("<I", data, 96)[0],
            "count": struct.unpack_from("<Q", data, 247)[0]}


def las_records(folder):
    """Every point record of the LAS tiles of a folder as its bytes, sorted, and the way they are coded, the same in every tile."""
    records, codings = [], set()
    for file in sorted(Path(folder).glob("*.las")):
        data = file.read_bytes()
        h = las_header(data)
        codings.add((h["scale"], h["offset"], h["format"], h["length"]))
        records += [data[h["begin"] + i * h["length"]:h["begin"] + (i + 1) * h["length"]] for i in range(h["count"])]
    return sorted(records), codings


def cloud_survey(folder, points, crs="EPSG:32632", file_crs=None):
    """A survey.toml with one point cloud."""
    folder.mkdir(parents=True, exist_ok=True)
    write_las(folder / "cloud.las", points)
    (folder / "survey.toml").write_text(f'name = "cloud"\ncrs = "{crs}"\n\n[[points]]\nfile = "cloud.las"\ncrs = "{file_crs or crs}"\n')
    return folder / "survey.toml"


# --- rasters

def raster(file):
    """{(x, y) of a cell's centre: bits of its value} for the cells that have a value."""
    done = subprocess.run([RASTER_VALUES, str(file)], capture_output=True, check=True, timeout=120)
    nx, ny, x0, dx, y0, dy = struct.unpack_from("<iidddd", done.stdout)
    values = struct.unpack_from(f"<{nx * ny}d", done.stdout, 40)
    return {(round(x0 + (k % nx + 0.5) * dx, 3), round(y0 + (k // nx + 0.5) * dy, 3)): v for k, v in enumerate(values) if v == v}


if __name__ == "__main__":
    sys.exit("run the *_test.py files")
