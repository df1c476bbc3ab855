# SPDX-License-Identifier: GPL-3.0-or-later
"""Points: NumPy to LAZ and back, Arrow, memory, bad input."""
import pickle
import subprocess
import sys
import unittest

import nanoarrow
import numpy as np
from support import InFolder, hill

import swath

CRS = "EPSG:32632"


def full(n=20_000, seed=4):
    """Something in every field of format 10 but the raw bytes, and extra fields of every type."""
    random = np.random.default_rng(seed)
    whole = lambda dtype, most=None, shape=n: random.integers(0, np.iinfo(dtype).max if most is None else most, shape, dtype="u8").astype(dtype)
    out = {"x": 500_000 + whole("i4", 1_000_000) * 0.001, "y": 5_300_000 + whole("i4", 1_000_000) * 0.001, "z": whole("i4", 900_000) * 0.001}
    # As a reader makes them: integer times scale plus offset.
    for name, offset in (("x", 500_000.0), ("y", 5_300_000.0), ("z", 0.0)):
        out[name] = np.round((out[name] - offset) / 0.001) * 0.001 + offset
    out |= {"intensity": whole("u2"), "return_number": whole("u1", 15) + np.uint8(1), "number_of_returns": np.full(n, 15, "u1"),
            "scan_direction_flag": whole("u1", 2), "edge_of_flight_line": whole("u1", 2), "classification": whole("u1"),
            "synthetic": whole("u1", 2), "key_point": whole("u1", 2), "withheld": whole("u1", 2), "overlap": whole("u1", 2), "scanner_channel": whole("u1", 4),
            "scan_angle": ((whole("i4", 60_001) - 30_000) * 0.006).astype("f4"), "user_data": whole("u1"), "point_source_id": whole("u2"),
            "gps_time": 3e8 + np.arange(n) * 1e-5, "red": whole("u2"), "green": whole("u2"), "blue": whole("u2"), "nir": whole("u2")}
    for kind in ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8"):
        out["e" + kind] = whole(kind)
    out |= {"ef4": random.normal(size=n).astype("f4"), "ef8": random.normal(size=n), "three": random.normal(size=(n, 3)).astype("f4"),
            "bytes": whole("u1", shape=(n, 5))}
    return out


class RoundTrip(InFolder):
    def test_structured_array_to_laz_and_back_is_exact(self):
        columns = full()
        array = np.empty(len(columns["x"]), [(n, c.dtype, c.shape[1:]) for n, c in columns.items()])
        for name, c in columns.items():
            array[name] = c
        for name in ("a.laz", "a.las"):
            swath.write_points(array, self.folder / name, CRS)
            back = swath.read_points(self.folder / name)
            self.assertEqual(back.storage.point_format, 8)
            again = back.array
            self.assertEqual(set(again.dtype.names), set(array.dtype.names))
            for field in array.dtype.names:
                self.assertEqual(again[field].dtype, array[field].dtype, field)
                np.testing.assert_array_equal(again[field], array[field], field)
            self.assertIn("UTM zone 32N", back.crs)
            # A second time: what was read is written and read the same.
            swath.write_points(back, self.folder / ("b" + name))
            np.testing.assert_array_equal(swath.read_points(self.folder / ("b" + name)).array, again)
            self.assertEqual((self.folder / name).read_bytes(), (self.folder / ("b" + name)).read_bytes())

    def test_scaled_extra_fields_keep_their_form(self):
        columns, _ = hill(3000)
        made = swath.dtm  # the module is there
        self.assertTrue(callable(made))
        points = swath.as_points(columns | {"sigma_v": np.linspace(0.01, 0.2, 3000).astype("f4")}, CRS)
        swath.write_points(points, self.folder / "a.laz")
        first = swath.read_points(self.folder / "a.laz")
        np.testing.assert_array_equal(first.sigma_v, points.sigma_v)
        self.assertEqual(first.sigma_v.dtype, np.float32)

    def test_legacy_formats(self):
        columns, _ = hill(5000)
        columns["classification"] = np.tile(np.uint8([1, 2, 12, 31]), 1250)
        for form in range(6):
            swath.write_points(columns, self.folder / "a.laz", CRS, point_format=form)
            back = swath.read_points(self.folder / "a.laz")
            self.assertEqual(back.storage.point_format, form)
            np.testing.assert_array_equal(back.classification, columns["classification"])
            self.assertEqual("gps_time" in back, form not in (0, 2))
        self.fault(swath.write_points, {**columns, "classification": columns["classification"] + np.uint8(40)}, self.folder / "b.laz", point_format=1)
        self.assertFalse((self.folder / "b.laz").exists())

    def test_several_files(self):
        columns, _ = hill(4000)
        points = swath.as_points(columns, CRS)
        for k in range(4):
            points[k * 1000:(k + 1) * 1000].write(self.folder / f"part{k}.laz", offset=(500_000, 5_300_000, 0))
        for given in (str(self.folder / "part*.laz"), [self.folder / f"part{k}.laz" for k in range(4)]):
            np.testing.assert_array_equal(swath.read_points(given).x, points.x)
        points.write(self.folder / "other.laz", crs="EPSG:32633")
        e = self.fault(swath.read_points, [self.folder / "part0.laz", self.folder / "other.laz"])
        self.assertIn("CRS", e.what)
        self.assertIn("other.laz", e.where)


class Columns(InFolder):
    def test_columns_are_views_and_shared(self):
        columns, _ = hill(1000)
        points = swath.as_points(columns, CRS)
        self.assertIs(points.x, columns["x"])
        changed = points.with_columns(classification=np.full(1000, 2), withheld=points.z > 410)
        self.assertIs(changed.x, points.x)
        self.assertNotIn("classification", points)
        self.assertEqual(changed.classification.dtype, np.uint8)
        np.testing.assert_array_equal(changed.withheld, points.z > 410)
        np.testing.assert_array_equal(changed["X"], np.round((points.x - 500_000) / 0.001))
        self.assertEqual(len(points[points.z > 410]), np.count_nonzero(points.z > 410))
        points.write(self.folder / "a.laz")
        back = swath.read_points(self.folder / "a.laz", columns=["intensity"])
        self.assertEqual(back.names, ("x", "y", "z", "intensity"))
        self.assertFalse(back.x.flags.writeable)
        self.assertIsNotNone(back.x.base)

    def test_arrow_holds_the_same_buffers(self):
        columns, _ = hill(1000)
        points = swath.as_points(columns | {"three": np.arange(3000.0).reshape(1000, 3)}, CRS)
        array = nanoarrow.Array(points)
        self.assertEqual([f.name for f in array.schema.fields], list(points.names))
        view = nanoarrow.c_array(points)
        for k, name in enumerate(points.names):
            column = points[name]
            child = view.child(k)
            child = child.child(0) if name == "three" else child
            data = np.asarray(child.view().buffer(1))
            np.testing.assert_array_equal(data.view(column.dtype).ravel(), column.ravel(), name)
            self.assertEqual(data.ctypes.data, column.ctypes.data, f"{name} was copied")
        stream = nanoarrow.ArrayStream(points).read_all()
        self.assertEqual(len(stream), 1000)
        del points, columns, array, view, stream  # and released without a fault


class Memory(InFolder):
    def test_ten_million_points_are_not_copied(self):
        """In a process of its own: what reading takes beside the columns."""
        script = f"""
import resource, numpy as np, swath
n = 10_000_000
i = np.arange(n)
swath.write_points({{"x": 5e5 + i % 1000, "y": 5.3e6 + i // 1000 * 0.5, "z": np.zeros(n), "gps_time": 4e8 + i * 1e-5,
                    "classification": np.full(n, 2, np.uint8)}}, r"{self.folder / "ten.laz"}", "EPSG:32632")
"""
        subprocess.run([sys.executable, "-c", script], check=True)
        script = f"""
import resource, sys, numpy as np, swath
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
points = swath.read_points(r"{self.folder / "ten.laz"}")
columns = sum(c.nbytes for c in points.columns.values())
views = [np.asarray(points[name]) for name in points.names]
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(len(points), columns, (peak - before) * 1024)
"""
        done = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True)
        n, columns, peak = map(int, done.stdout.split())
        print(f"10 M points: columns of {columns / 1e6:.0f} MB, peak {peak / 1e6:.0f} MB above the process before")
        self.assertEqual(n, 10_000_000)
        # Batches of 262144 points and the decoder's chunks on every thread; a copy of the columns would be 100 % more.
        self.assertLess(peak, columns + 200e6)


class BadInput(InFolder):
    def test_one_clear_error(self):
        columns, _ = hill(100)
        nowhere = self.folder / "no.laz"
        (self.folder / "a file").write_text("")
        cases = [
            (swath.read_points, (nowhere,), "no.laz", ""),
            (swath.read_points, (str(self.folder / "no*.laz"),), "no*.laz", ""),
            (swath.read_points, ([],), "read_points", ""),
            (swath.write_points, ({"x": columns["x"], "y": columns["y"]}, nowhere), "points", ""),
            (swath.write_points, ({**columns, "z": columns["z"][:50]}, nowhere), "Points", "length"),
            (swath.write_points, (columns, self.folder / "no.txt"), "no.txt", ".las or .laz"),
            (swath.write_points, (columns, self.folder / "a file" / "no.laz"), "a file", ""),
            (swath.write_points, ({**columns, "z": np.where(columns["z"] > 410, np.nan, columns["z"])}, nowhere), "z: row", "nan"),
            (swath.write_points, ({**columns, "intensity": np.full(100, 70000)}, nowhere), "intensity: row 0", "70000"),
            (swath.write_points, ({**columns, "intensity": np.full(100, 1.5)}, nowhere), "intensity: row 0", "1.5"),
            (swath.write_points, ({**columns, "return_number": np.full(100, 16)}, nowhere), "no.laz", ""),
            (swath.write_points, ({**columns, "name": np.array(["a"] * 100)}, nowhere), "name", "not numbers"),
            (swath.write_points, ({**columns, "n" * 33: columns["z"]}, nowhere), "n" * 33, "32 bytes"),
            (swath.write_points, (columns, nowhere, "EPSG:99999"), "EPSG:99999", ""),
            (swath.write_points, (columns["x"], nowhere), "points", "structured"),
        ]
        for call, args, where, what in cases:
            with self.subTest(where=where, what=what):
                e = self.fault(call, *args)
                self.assertIn(where, e.where + e.what)
                self.assertIn(what, e.what + e.hint)
                self.assertFalse(nowhere.exists())
        self.assertIn("point_format", self.fault(swath.write_points, columns, nowhere, point_format=11).where)
        self.assertIn("scale", self.fault(swath.write_points, columns, nowhere, scale=0).where)
        self.assertIn("does not fit", self.fault(swath.write_points, columns, nowhere, offset=(0, 0, 0), scale=1e-4).what)
        swath.write_points(columns, self.folder / "a.laz")
        e = self.fault(swath.read_points, self.folder / "a.laz", columns=["intensiti"])
        self.assertEqual(e.hint, "did you mean 'intensity'?")
        e = self.fault(lambda: swath.read_points(self.folder / "a.laz")["clasification"])
        self.assertEqual(e.hint, "did you mean 'classification'?")

    def test_a_damaged_file(self):
        columns, _ = hill(2000)
        swath.write_points(columns, self.folder / "a.laz")
        data = (self.folder / "a.laz").read_bytes()
        (self.folder / "a.laz").write_bytes(data[:len(data) // 2])
        e = self.fault(swath.read_points, self.folder / "a.laz")
        self.assertIn("a.laz", e.where)
        self.assertEqual(e.code, 1)

    def test_errors_travel_between_processes(self):
        e = self.fault(swath.read_points, "no.laz")
        again = pickle.loads(pickle.dumps(e))
        self.assertEqual((again.what, again.where, again.hint, str(again)), (e.what, e.where, e.hint, str(e)))


if __name__ == "__main__":
    unittest.main()
