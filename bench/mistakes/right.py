# SPDX-License-Identifier: GPL-3.0-or-later
"""Right surveys of many kinds: what the gate must not warn of."""
import numpy as np

PATTERNS = ("triangle", "sine", "polygon", "profile", "beam", "multibeam", "conical", "palmer")
SCENES = ("flat", "hills", "steep", "forest", "town", "mixed", "airfield", "zoo")
PLACES = ((47.906, 10.512, 32632), (-33.9, 18.5, 32734), (60.2, 24.9, 32635), (1.3, 103.8, 32648), (-41.2, 174.8, 32760), (40.0, -105.2, 32613))
BUILT = ("town", "mixed", "airfield")  # scenes with roofs to survey
RETURNS = 40000  # pulses of a line


def options(index):
    """Options of `swath simulate` of right survey number `index`, the same for every run of the bench."""
    draw = np.random.default_rng(1000 + index)
    pattern, scene = PATTERNS[index % 8], SCENES[(index + index // 8) % 8]
    latitude, longitude, code = PLACES[draw.integers(len(PLACES))]
    half, speed = draw.uniform(10, 32), draw.uniform(30, 75)
    height = 10 ** draw.uniform(np.log10(150), np.log10(1300))
    lines, overlap, length = 1 if index % 20 == 3 else int(draw.integers(2, 5)), draw.uniform(0.1, 0.7), draw.uniform(250, 600)
    if index % 20 == 13:  # a single short line over ground whose slopes look like roll
        lines, scene, length = 1, ("steep", "forest")[index // 20 % 2], speed * draw.uniform(6, 10)
    swath = max(2 * height * np.tan(np.radians(min(half, 15) if pattern == "palmer" else half)), 20)
    width = float(np.clip(swath * (1 + (lines - 1) * (1 - overlap)), 120, 1500))
    prf = float(np.clip(RETURNS * speed / length, 500, 2e5))
    out = {"seed": 100 + index, "crs": f"EPSG:{code}", "latitude": f"{latitude + draw.uniform(-0.3, 0.3):.4f} deg",
           "longitude": f"{longitude + draw.uniform(-0.3, 0.3):.4f} deg", "world.scene": scene, "world.length": f"{length:.0f} m", "world.width": f"{width:.0f} m",
           "world.ground": f"{draw.uniform(0, 1500):.0f} m", "flight.lines": lines, "flight.cross_lines": int(draw.integers(0,
                                                                                                                            2)), "flight.overlap": round(overlap, 2),
           "flight.height": f"{height:.0f} m", "flight.speed": f"{speed:.0f} m/s", "flight.direction": f"{draw.uniform(0, 360):.0f} deg",
           "flight.wind": f"{draw.uniform(0, 12):.0f} m/s", "flight.wind_from": f"{draw.uniform(0, 360):.0f} deg", "flight.turbulence": round(draw.uniform(0.2, 1.5), 2),
           "scanner.pattern": pattern, "scanner.prf": f"{prf:.0f} Hz", "scanner.half_angle": f"{half:.1f} deg",
           "scanner.frequency": f"{np.clip(np.sqrt(speed * prf / 4 / swath), 5, 200):.0f} Hz",
           "imu.file": "true", "gnss.file": "true", "imu.grade": str(draw.choice(["navigation", "tactical", "compact", "mems"])),
           "imu.kind": str(draw.choice(["increments", "rates"])), "gnss.velocity": str(bool(draw.integers(2))).lower(),
           "mounting.deliver": str(draw.choice(["truth", "drawn"])), "noise.line_shift": f"{draw.uniform(0, 4):.1f} cm",
           "noise.line_attitude": f"{draw.uniform(0, 0.006):.4f} deg", "output.truth_returns": "true"}
    if draw.integers(2):
        out.update({"control.points": 12, "control.targets": 2 if scene in BUILT else 0})
    if draw.integers(3) == 0:
        out["flight.still"] = "60 s"
    if draw.integers(3) == 0:
        out["output.formats"] = '["csv"]'
    if draw.integers(5) == 0:
        out["output.start"] = "604650 s"  # the week rolls over in flight
    return out
