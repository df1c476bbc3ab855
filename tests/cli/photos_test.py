# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of points and orthophotos from simulated photographs, from raw records and of clouds; mistakes of their tables."""
import json
import shutil
import struct
import unittest

from support import SOURCE, Case, raster, stage, substitute, swath

CONFIGS = SOURCE / "configs"
SURVEY = ["world.scene=hills", "world.trees=0", "world.buildings=0", "world.low_vegetation=0", "world.crops=0", "world.length=160 m",
          "world.width=120 m", "flight.lines=2", "flight.cross_lines=0", "flight.height=300 m", "scanner.prf=6 kHz", "mounting.deliver=truth",
          "events.file=true", "events.interval=0.7 s", "camera.file=true", "camera.photos=true", "camera.columns=400", "camera.rows=300",
          "camera.f=20 mm", "camera.nominal_f=20 mm", "camera.pixel=40 um", "camera.k1=-6e-5", "camera.k2=0", "camera.points=60"]
# Raw records to coloured points and an orthophoto in one run: nothing but the folder of photographs is named.
CHAIN = ("readers.trajectory", "time.sync", "orientation.direct", "block.adjust", "readers.laser", "georeference", "filters.smrf", "terrain.dtm",
         "images.orthophoto", "images.colour", "writers.las")


def points(folder):
    """(x, y, return number, red) of the points of all tiles."""
    out = []
    for file in sorted(folder.rglob("*.las")):
        data = file.read_bytes()
        form, length = data[104] & 63, struct.unpack_from("<H", data, 105)[0]
        begin, = struct.unpack_from("<I", data, 96)
        count, = struct.unpack_from("<Q", data, 247)
        scale, offset = struct.unpack_from("<3d", data, 131), struct.unpack_from("<3d", data, 155)
        assert form == 7, form
        for k in range(count):
            at = begin + k * length
            x, y = struct.unpack_from("<ii", data, at)
            out.append((x * scale[0] + offset[0], y * scale[1] + offset[1], data[at + 14] & 15, struct.unpack_from("<H", data, at + 30)[0]))
    return out


class Photos(Case):
    simulated = SURVEY

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.cloud = cls.class_folder / "cloud"
        done = swath("run", CONFIGS / "georeference.toml", "--survey", cls.survey / "survey.toml", "--output", cls.cloud, "--quiet")
        assert done.returncode == 0, done.stderr
        truth = raster(cls.survey / "truth" / "orthophoto.tif")
        cls.cell = round(min(abs(a[0] - b[0]) for a, b in zip(truth, list(truth)[1:]) if a[0] != b[0]), 3)
        cls.truth = {(round(x / cls.cell - 0.5), round(y / cls.cell - 0.5)): v for (x, y), v in truth.items()}

    def given(self, **other):
        words = {"photos": self.survey / "photos", "orientation": self.survey / "truth" / "orientation.csv",
                 "camera": self.survey / "truth" / "camera.toml", **other}
        return [w for key, value in words.items() for w in (f"--{key}", value)]

    def truth_at(self, x, y):
        return self.truth.get((int(x // self.cell), int(y // self.cell)))

    def assert_colours(self, found, worst):
        """Mean difference of 8-bit values of the same places, and of places nine metres aside."""
        here = [abs(v / 256 - self.truth_at(x, y)) for x, y, v in found if self.truth_at(x, y) is not None]
        aside = [abs(v / 256 - self.truth_at(x + 9, y)) for x, y, v in found if self.truth_at(x + 9, y) is not None]
        self.assertGreater(len(here), 1000)
        self.assertLess(sum(here) / len(here), worst)
        self.assertGreater(sum(aside) / len(aside), 1.6 * sum(here) / len(here))

    def test_points_have_the_colours_of_their_places(self):
        done = swath("colour", self.cloud / "points", *self.given(), "--output", self.out, "--quiet", "--set", "writers.las.compress=false")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        coloured = points(self.out / "points")
        self.assertLess(sum(red == 0 for *_, red in coloured), 0.02 * len(coloured))
        self.assert_colours([(x, y, red) for x, y, _, red in coloured if red > 0], 9.0)
        # Other tiles, the same colours.
        done = swath("colour", self.cloud / "points", *self.given(), "--output", self.folder / "tiles", "--quiet", "--set", "run.tile=50 m",
                     "--set", "writers.las.compress=false")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(points(self.folder / "tiles" / "points")), sorted(coloured))

    def test_the_orthophoto_is_the_ground_from_above(self):
        done = swath("orthophoto", self.cloud / "points", *self.given(), "--pixel", f"{self.cell} m", "--output", self.out, "--quiet")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for name in ("orthophoto", "true_orthophoto"):
            found = {}
            for file in (self.out / name).glob("*.tif"):
                if not file.stem.endswith("_quality"):
                    found.update(raster(file))
            self.assert_colours([(x, y, 256 * v) for (x, y), v in found.items()], 6.5)
            self.assertTrue((self.out / f"{name}_quality.vrt").exists())
            self.assertTrue((self.out / f"{name}.vrt").exists())
            listed = (self.out / f"{name}_images.csv").read_text().splitlines()
            self.assertEqual(len(listed), 1 + len(list((self.survey / "photos").iterdir())))
            self.assertEqual(sum(int(line.split(",")[3]) for line in listed[1:]), len(found))

    def test_from_raw_records_in_one_run(self):
        config = self.folder / "chain.toml"
        config.write_text("".join(f'\n[[stage]]\ntype = "{name}"\n' for name in CHAIN) + "compress = false\n")
        report = self.run_ok(self.survey / "survey.toml", config=config)
        coloured = points(self.out / "points")
        self.assert_colours([(x, y, red) for x, y, _, red in coloured if red > 0], 10.0)
        found = stage(report, "images.orthophoto")["findings"]
        self.assertEqual(found["images"], len(list((self.survey / "photos").iterdir())))
        self.assertGreater(found["images_used"], 1)
        self.assertLess(found["sigma_plan_m"], 0.2)
        self.assertGreater(found["sigma_plan_m"], 0.005)
        self.assertTrue((self.out / "block" / "orientation_camera.csv").exists())
        # A tilt and a principal point are uncertain together: without that the sigma is much larger.
        (self.folder / "given").mkdir()
        for file in ("orientation.csv", "camera.toml"):
            shutil.copy(self.out / "block" / file, self.folder / "given")
        done = swath("orthophoto", self.cloud / "points", "--photos", self.survey / "photos", "--orientation",
                     self.folder / "given" / "orientation.csv", "--camera", self.folder / "given" / "camera.toml", "--output",
                     self.folder / "exact", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        exact = stage(json.loads((self.folder / "exact" / "report.json").read_text()), "images.orthophoto")["findings"]["sigma_plan_m"]
        self.assertGreater(exact, 2.0 * found["sigma_plan_m"])
        # Another photograph under the name of one: the run is made anew.
        changed = self.copy()
        names = sorted((changed / "photos").iterdir())
        shutil.copy(names[0], names[len(names) // 2])
        self.run_ok(changed / "survey.toml", config=config)
        other = points(self.out / "points")
        self.assertEqual([p[:3] for p in other], [p[:3] for p in coloured])
        self.assertGreater(sum(a[3] != b[3] for a, b in zip(other, coloured)), 1000)

    def test_mistakes_are_named(self):
        cloud = self.cloud / "points"

        def refused(code, *words, **other):
            self.assert_error(swath("colour", cloud, *self.given(**other), "--output", self.out, "--quiet"), code, *words)

        refused(2, "no such folder", photos=self.folder / "none")
        refused(2, "no such file", orientation=self.folder / "none.csv")
        (self.folder / "empty").mkdir()
        refused(1, r"no file in the folder matches an oriented image \(first: 1\)", photos=self.folder / "empty")
        camera = self.folder / "camera.toml"
        camera.write_text((self.survey / "truth" / "camera.toml").read_text().replace("columns = 400", "columns = 401"))
        refused(1, "the image has 400 x 300 pixels, camera camera has 401 x 300", camera=camera)
        table = self.folder / "orientation.csv"
        table.write_text((self.survey / "truth" / "orientation.csv").read_text().replace("EPSG:32632", "EPSG:32632+5773"))
        refused(1, "heights of the orientations are", orientation=table)
        table.write_text((self.survey / "truth" / "orientation.csv").read_text().replace("EPSG:32632", "EPSG:32633"))
        refused(1, "no photograph sees the survey; the nearest", orientation=table)
        table.write_text((self.survey / "truth" / "orientation.csv").read_text().replace(",phi,", ",fi,"))
        refused(1, "no column 'phi'", orientation=table)
        config = self.folder / "plain.toml"
        config.write_text('[[stage]]\ntype = "readers.las"\n\n[[stage]]\ntype = "images.colour"\n\n[[stage]]\ntype = "writers.las"\n')
        survey = self.folder / "cloud.toml"
        survey.write_text(f'crs = "EPSG:32632"\n[[points]]\nfile = "{next(cloud.glob("*.las"))}"\n')
        self.assert_refused(survey, 2, r"names no \[\[photos\]\]", config=config)
        substitute(survey, "[[points]]", f'[[photos]]\nfolder = "{self.survey / "photos"}"\n\n[[points]]')
        self.assert_refused(survey, 2, "nothing orients the photographs", config=config)


if __name__ == "__main__":
    unittest.main()
