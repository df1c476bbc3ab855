# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks of images on the command line: accuracy before the flight, drifts of stations."""
import json
import unittest

from support import SOURCE, Case, swath

# Ackermann's Quadro 1, recomputed; 0.5 % of each.
QUADRO_1 = [(0.959, 1.502), (1.620, 1.680), (2.101, 2.288), (1.533, 2.268)]


class Block(Case):
    def test_quadro_1(self):
        done = swath("block-theory", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        cases = json.loads(done.stdout)["cases"]
        self.assertEqual(len(cases), 4)
        for case, (xy, z) in zip(cases, QUADRO_1):
            self.assertAlmostEqual(case["mu_xy"], xy, delta=0.005 * xy, msg=case["case"])
            self.assertAlmostEqual(case["mu_z"], z, delta=0.005 * z, msg=case["case"])

    def test_a_config_and_its_options(self):
        config = SOURCE / "configs" / "flight" / "block_theory.toml"
        fine = json.loads(swath("block-theory", config, "--json").stdout)["cases"]
        poor = json.loads(swath("block-theory", config, "--set", 'sigma_station="3 m"', "--json").stdout)["cases"]
        self.assertEqual([c["case"] for c in fine], ["no drift, chains", "strip drift, two cross strips"])
        for a, b in zip(fine, poor):
            self.assertTrue(1.65 < b["mu_xy"] / a["mu_xy"] < 2.35)
        self.assert_error(swath("block-theory", config, "--set", "strips=0"), 2, "strips")
        self.assert_error(swath("block-theory", config, "--set", 'sigma_station="3"'), 2, "sigma_station")

    def test_what_is_not_determined_is_named(self):
        config = self.folder / "corners.toml"
        config.write_text('[[case]]\nname = "corners"\ndrift = "strip"\ncontrol = "corners"\n')
        done = swath("block-theory", config)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, "corners: refused: .*heights.*cross strips.*chains of height control")

    def test_drifts(self):
        table = self.folder / "differences.csv"
        table.write_text("strip,time,dx,dy\n1,0,1.0,0\n1,10,2.0,0\n1,20,3.0,0\n2,100,5,1\n2,110,5,-1\n")
        found = json.loads(swath("block-drift", table, "--json").stdout)
        self.assertEqual([f["coordinate"] for f in found], ["dx", "dy"])
        self.assertAlmostEqual(found[0]["strips"][0]["drift_per_s"], 0.1)
        self.assertAlmostEqual(found[0]["strips"][0]["rms_less_line"], 0.0)
        self.assertIn("strip 2", swath("block-drift", table, "--column", "dy").stdout)
        self.assert_error(swath("block-drift", table, "--column", "dz"), 1, "dz")
        table.write_text("strip,time,dx\n1,0,x\n")
        self.assert_error(swath("block-drift", table), 1, "differences.csv:2")
        table.write_text("strip,time\n1,0\n")
        self.assert_error(swath("block-drift", table), 1, "no column of differences")


if __name__ == "__main__":
    unittest.main()
