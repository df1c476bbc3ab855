# SPDX-License-Identifier: GPL-3.0-or-later
"""Buildings of a small simulated town; its CityJSON by readers that are not ours."""
import collections
import json
import os
import shutil
import subprocess
import unittest

from support import SOURCE, Case, stage, swath

TOWN = ["imu.file=false", "gnss.file=false", "world.scene=town", "world.length=160 m", "world.width=120 m", "flight.lines=2", "flight.cross_lines=0",
        "flight.height=250 m", "scanner.prf=20 kHz", "mounting.deliver=truth"]


class Buildings(Case):
    simulated = TOWN

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        config = cls.survey.parent / "buildings.toml"
        text = (SOURCE / "configs" / "buildings.toml").read_text()
        first = "".join(f'[[stage]]\ntype = "{s}"\n' for s in ("readers.trajectory", "readers.laser", "georeference", "filters.returns"))
        config.write_text(text.replace('[[stage]]\ntype = "readers.las"\n', first))
        cls.made = cls.survey.parent / "made"
        done = swath("run", config, "--survey", cls.survey / "survey.toml", "--output", cls.made, "--quiet")
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        cls.city = json.loads((cls.made / "buildings.city.json").read_text())

    def test_solids_are_closed_and_look_outwards(self):
        vertices = self.city["vertices"]
        solids = [g for o in self.city["CityObjects"].values() for g in o["geometry"] if g["type"] == "Solid"]
        self.assertGreater(len(solids), 2)
        for solid in solids:
            (shell,) = solid["boundaries"]
            edges = collections.Counter((a, b) for surface in shell for ring in surface for a, b in zip(ring, ring[1:] + ring[:1]))
            self.assertEqual(set(edges.values()), {1})
            self.assertEqual({(b, a) for a, b in edges}, set(edges))
            volume = 0
            for surface in shell:
                for ring in surface:
                    p = [[c - d for c, d in zip(vertices[v], vertices[shell[0][0][0]])] for v in ring]
                    for b, c in zip(p[1:], p[2:]):
                        a = p[0]
                        volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]))
            self.assertGreater(volume, 0)

    def test_the_report_and_the_files_agree(self):
        found = stage(json.loads((self.made / "report.json").read_text()), "terrain.buildings")["findings"]
        self.assertEqual(found["buildings"], len(self.city["CityObjects"]))
        self.assertEqual(found["buildings"], len((self.made / "buildings.csv").read_text().splitlines()) - 1)
        self.assertGreater(found["explained"], 0.8)

    def test_the_validator_of_cityjson_takes_it(self):
        validator = os.environ.get("SWATH_CJVAL") or shutil.which("cjval")
        if not validator:
            self.skipTest("no cjval: `cargo install cjval --features build-binary`, or set SWATH_CJVAL")
        done = subprocess.run([validator, self.made / "buildings.city.json"], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertNotIn("invalid", (done.stdout + done.stderr).lower())


if __name__ == "__main__":
    unittest.main()
