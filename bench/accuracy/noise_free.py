# SPDX-License-Identifier: GPL-3.0-or-later
"""Records without noise, 5 km lines, every pattern of scan: what the chain ECEF -> map itself adds."""
import common

STAGES = [{"type": t} for t in ("readers.trajectory", "readers.laser", "georeference", "report.truth")]
PATTERNS = {"triangle": "csv", "sine": "npy", "polygon": "csv", "profile": "npy", "beam": "npy", "conical": "csv", "palmer": "npy"}

folder = common.scratch("noise_free")
rows = []
for pattern, form in PATTERNS.items():
    survey = common.simulate(
        folder / pattern, world__length="5000 m", world__width="200 m", world__scene="hills", world__trees=0, flight__lines=2, flight__cross_lines=0,
        flight__height="1000 m", scanner__pattern=pattern, scanner__prf="500 Hz", noise__noise_free="true", mounting__deliver="truth",
        mounting__truth__latency="2 ms", mounting__truth__scan_offset="0.02 deg", mounting__truth__range_scale=1.00001,
        output__formats=f'["{form}"]', imu__file="false", gnss__file="false", output__dtm_cell="100 m")
    found = common.stage_of(common.run(STAGES, survey / "survey.toml", folder / f"{pattern}_out"), "report.truth")["findings"]
    points = found["points"]
    rows.append([pattern, form, points["compared"], f"{1e6 * found['rms_3d']:.3f}", f"{1e6 * points['largest_3d_m']:.3f}"])
common.table(["pattern", "records", "returns", "RMS 3D um", "largest 3D um"], rows)
