# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the package share: made clouds, simulated surveys, a folder of their own."""
import functools
import os
import tempfile
import unittest
from pathlib import Path

import numpy as np

import swath

SOURCE = Path(os.environ["SWATH_SOURCE"])


class InFolder(unittest.TestCase):
    def setUp(self):
        kept = tempfile.TemporaryDirectory(prefix="swath-test-")
        self.addCleanup(kept.cleanup)
        self.folder = Path(kept.name)

    def fault(self, call, *args, **named):
        """The swath.Error that a call must raise."""
        with self.assertRaises(swath.Error) as caught:
            call(*args, **named)
        return caught.exception


def hill(n=60_000, side=300.0, seed=1):
    """A slope with a hill, boxes (8 m high) and scattered trees: columns by LAS names, on multiples of 1 mm, with what it is."""
    random = np.random.default_rng(seed)
    x, y = random.uniform(0, side, (2, n))
    z = 0.05 * x + 6 * np.exp(-((x - 150) ** 2 + (y - 150) ** 2) / 3000) + random.normal(0, 0.02, n)
    building = ((x // 40 % 3 == 1) & (y // 40 % 3 == 1)) & (x % 40 > 12) & (x % 40 < 28) & (y % 40 > 12) & (y % 40 < 28)
    tree = ~building & (random.random(n) < 0.15)
    z = z + np.where(building, 8.0, 0.0) + np.where(tree, random.uniform(1.0, 12.0, n), 0.0)
    whole = lambda v, by: np.round(v + by, 3)
    return {"x": whole(x, 500_000), "y": whole(y, 5_300_000), "z": whole(z, 400), "gps_time": 4.1e8 + np.arange(n) * 1e-5,
            "return_number": np.ones(n, np.uint8), "number_of_returns": np.ones(n, np.uint8), "intensity": random.integers(0, 4000, n).astype(np.uint16),
            "point_source_id": np.ones(n, np.uint16)}, ~(building | tree)


@functools.cache
def survey(scene="flat", imu=False):
    """The folder of a small simulated survey; it goes at the end of the process."""
    kept = tempfile.TemporaryDirectory(prefix="swath-survey-")
    survey.kept.append(kept)
    folder = Path(kept.name) / "demo"
    swath.simulate(folder, **SIMULATION, world={"scene": scene})
    return folder


survey.kept = []
SIMULATION = {"seed": 3, "flight": {"lines": 2}}
