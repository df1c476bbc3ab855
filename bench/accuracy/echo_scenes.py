# SPDX-License-Identifier: GPL-3.0-or-later
"""Clouds with truth from an echo model that is independent of `swath simulate`: pulses straight down on relief, layers of vegetation that stop them, one
echo per layer, houses as boxes. For ground_calibration.py, which must not learn the program's own simulator."""
import numpy as np

CANOPY = (6.0, 18.0)       # m over the ground
PULSE = 0.6                # m: closer echoes of one pulse are one
NOISE = 0.03               # m
# name: seed, pulses per m2, slope, share of pulses that reach the ground, share that a low layer stops where it grows, size of its patches (m), its heights (m), at its top alone
SCENES = {
    "understorey": (500, 3, 0.05, 0.30, 0.40, 12, (0.5, 2.0), False),
    "understorey, slope": (501, 3, 0.30, 0.30, 0.40, 12, (0.5, 2.0), True),
    "understorey, wide": (502, 3, 0.15, 0.30, 0.45, 30, (0.5, 2.0), True),
    "understorey, dense survey": (503, 8, 0.15, 0.30, 0.45, 20, (0.5, 2.0), True),
    "understorey, steep": (504, 4, 0.40, 0.20, 0.50, 15, (0.5, 2.0), True),
    "understorey, sparse survey": (505, 1, 0.10, 0.40, 0.30, 15, (0.5, 2.0), True),
    "understorey, closed": (506, 3, 0.10, 0.30, 0.55, 40, (0.5, 2.0), False),
    "crop": (400, 3, 0.05, 0.40, 0.60, 25, (0.3, 0.9), True),
    "low crop": (401, 3, 0.05, 0.50, 0.50, 25, (0.15, 0.4), True),
    "low crop, dense survey": (402, 10, 0.05, 0.50, 0.50, 25, (0.15, 0.4), True),
    "crop, sparse survey": (403, 1, 0.05, 0.50, 0.50, 25, (0.3, 1.2), True),
}
SIDE = 140.0  # m


def value_noise(seed, x, y, scale):
    """Smooth noise of standard deviation about 1."""
    grid = np.random.default_rng(seed).normal(size=(64, 64))
    u, v = x / scale % 62, y / scale % 62
    i, j = u.astype(int), v.astype(int)
    a, b = (part * part * (3 - 2 * part) for part in (u - i, v - j))
    return (grid[i, j] * (1 - a) + grid[i + 1, j] * a) * (1 - b) + (grid[i, j + 1] * (1 - a) + grid[i + 1, j + 1] * a) * b


def terrain(seed, slope, x, y):
    return 100 + slope * x + 3 * value_noise(seed + 77, x, y, 60) + 0.03 * value_noise(seed + 78, x, y, 3)


def cloud(name, seed=None):
    """Rows of easting, northing, height, return number, number of returns, strip; true where a return is from the ground. `seed`: of another draw."""
    own_seed, density, slope, to_ground, to_low, patch, (lowest, highest), top_only = SCENES[name]
    seed = own_seed if seed is None else seed
    random = np.random.default_rng(seed)
    count = int(density * SIDE * SIDE)
    x, y = random.uniform(0, SIDE, (2, count))
    ground = terrain(seed, slope, x, y)
    top = np.clip(lowest + (highest - lowest) * (0.5 + 0.35 * value_noise(seed + 6, x, y, 4)), lowest, highest)
    low = top * random.uniform(0.8, 1, count) if top_only else lowest + (top - lowest) * random.random(count) ** 0.7
    share, grows = random.random(count), value_noise(seed + 5, x, y, patch) > -0.5
    in_canopy = share > to_ground + to_low
    in_low = ~in_canopy & (share > to_ground) & grows
    canopy = random.uniform(*CANOPY, count)
    last = np.where(in_canopy, canopy, np.where(in_low, low, 0.0))
    # Echoes from above: of the canopy for most pulses that pass it, of the low layer for some that pass that too.
    first = np.where(~in_canopy & (random.random(count) < 0.6), canopy, np.nan)
    middle = np.where((last == 0) & grows & (low > PULSE) & (random.random(count) < 0.3), low, np.nan)
    echoes = np.stack([first, middle, last], axis=1)
    seen = np.isfinite(echoes)
    pulse, echo = np.nonzero(seen)
    z = ground[pulse] + echoes[pulse, echo] + random.normal(0, NOISE, len(pulse))
    number, of = np.cumsum(seen, axis=1)[pulse, echo], seen.sum(axis=1)[pulse]
    return np.stack([x[pulse], y[pulse], z, number, of, np.ones(len(pulse))], axis=1), (echo == 2) & (last[pulse] == 0)
