# SPDX-License-Identifier: GPL-3.0-or-later
"""From raw records: simulated surveys, trajectories, georeferenced returns."""

from __future__ import annotations

import json
import os
import tempfile
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from . import _swath
from ._columns import Array, las_columns, nearest
from ._errors import usage_error
from ._points import Points, Storage
from ._report import report_of
from ._runs import MEMORY_BESIDE, plain, run_table, survey_file

Survey = str | os.PathLike[str] | Mapping[str, Any]
TRAJECTORY_COLUMNS = ("time", "latitude", "longitude", "height", "roll", "pitch", "heading", "v_north", "v_east", "v_down", "sigma_north",
                      "sigma_east", "sigma_down", "sigma_roll", "sigma_pitch", "sigma_heading")
IMU_COLUMNS = ("time", "gyro_x", "gyro_y", "gyro_z", "accelerometer_x", "accelerometer_y", "accelerometer_z")
GNSS_COLUMNS = ("time", "latitude", "longitude", "height", "x", "y", "z", "cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz",
                "sigma_north", "sigma_east", "sigma_up", "v_north", "v_east", "v_up", "sigma_v_north", "sigma_v_east", "sigma_v_up",
                "quality", "satellites")
LASER_COLUMNS = ("time", "line", "scan_angle", "range", "intensity", "return_number", "return_count", "x", "y", "z")


class Trajectory:
    """A trajectory of the IMU's centre: time (GPS seconds), latitude, longitude, roll, pitch, heading (rad), height (ellipsoidal m), v_north,
    v_east, v_down (m/s), and their standard deviations sigma_north ... sigma_heading (m, rad), as views of what the smoother made.

    It keeps the full covariances, which a later georeference() uses. report: of the run that made it.
    """

    def __init__(self, held: Any, report: Any, max_gap: float) -> None:
        self.held = held
        self.report = report
        self.max_gap = max_gap

    def __len__(self) -> int:
        size: int = self.held.size()
        return size

    def __getattr__(self, name: str) -> Array:
        if name not in TRAJECTORY_COLUMNS:
            raise AttributeError(f"a trajectory has no '{name}'")
        column = self.held.column(name)
        if column is None:
            raise AttributeError(f"this trajectory states no {name}")
        found: Array = column
        return found

    def __getitem__(self, name: str) -> Array:
        return self.__getattr__(name)

    @property
    def array(self) -> Array:
        """A structured array of all columns, a copy."""
        columns = {n: c for n in TRAJECTORY_COLUMNS if (c := self.held.column(n)) is not None}
        out = np.empty(len(self), [(n, c.dtype) for n, c in columns.items()])
        for name, column in columns.items():
            out[name] = column
        return out

    def __repr__(self) -> str:
        return f"<swath.Trajectory: {len(self)} records over {self.time[-1] - self.time[0]:.1f} s>"


def read_survey(survey: Survey) -> dict[str, Any]:
    """A survey.toml (or the same as .json, or a dict) as a dict, its files with their whole names."""
    if isinstance(survey, Mapping):
        return {k: plain(v) for k, v in survey.items()}
    file = Path(survey)
    try:
        text = file.read_text(encoding="utf-8")
        tree = json.loads(text) if file.suffix == ".json" else tomllib.loads(text)
    except OSError as fault:
        raise usage_error(f"cannot read: {fault.strerror}", str(file)) from None
    except ValueError as fault:
        raise usage_error(str(fault), str(file)) from None

    def absolute(value: Any) -> Any:
        if isinstance(value, dict):
            return {k: absolute(v) for k, v in value.items()}
        if isinstance(value, list):
            return [absolute(v) for v in value]
        if isinstance(value, str) and value and (file.parent / value).is_file():
            return str((file.parent / value).resolve())
        return value

    found: dict[str, Any] = absolute(tree)
    return found


def _columns(given: Any, known: tuple[str, ...], name: str) -> dict[str, Array]:
    """Columns of records by name, float64."""
    if isinstance(given, np.ndarray) and given.dtype.names:
        given = {n: given[n] for n in given.dtype.names}
    if not isinstance(given, Mapping) or not given:
        raise usage_error("is neither a structured array nor a mapping of names to arrays", name, "its columns: " + ", ".join(known))
    out = {}
    for column, values in given.items():
        if column not in known:
            raise usage_error(f"no column is named '{column}'", name, nearest(column, known) or "columns: " + ", ".join(known))
        out[column] = np.asarray(values, np.float64)
        if out[column].ndim != 1 or len(out[column]) != len(next(iter(out.values()))):
            raise usage_error(f"{column} has the shape {out[column].shape}; columns have one dimension and one length", name)
    if "time" not in out:
        raise usage_error("has no column 'time'", name, nearest("time", given))
    return out


def _entry(file: Path, columns: Mapping[str, Array], default: Mapping[str, Any], given: Mapping[str, Any] | None) -> dict[str, Any]:
    """The entry of survey.toml for columns, written to a file."""
    if file.suffix == ".npy":
        rows = np.empty(len(columns["time"]), [(n, c.dtype) for n, c in columns.items()])
        for name, c in columns.items():
            rows[name] = c
        np.save(file, rows)
    else:
        np.savetxt(file, np.column_stack(list(columns.values())), fmt="%.17g", delimiter=",", header=",".join(columns), comments="")
    return {"file": str(file), **default, **(given or {}), "columns": {n: n for n in columns}}


def _expect(survey: Mapping[str, Any], key: str, what: str, where: str, hint: str) -> None:
    """Raises Error where neither the call nor the survey has these records."""
    if not survey.get(key):
        raise usage_error(f"no {what}", f"{where}: {key}", hint)


def smooth(imu: Any = None, gnss: Any = None, *, survey: Survey | None = None, imu_format: Mapping[str, Any] | None = None,
           gnss_format: Mapping[str, Any] | None = None, threads: int | None = None, memory: str | None = None, progress: bool = False,
           **options: Any) -> Trajectory:
    """The smoothed trajectory of a flight from its IMU and GNSS records: the stage trajectory.ins_gnss.

    imu: columns time, gyro_x, gyro_y, gyro_z (rad/s), accelerometer_x ... (m/s2) in body axes (forward, right, down), as a structured array
    or a mapping; gnss: time, latitude, longitude (deg), height (ellipsoidal m) or x, y, z (ECEF m), with sigma_north, sigma_east, sigma_up
    or cov_xx ... Times are GPS seconds. imu_format, gnss_format: keys of [[imu]] and [[gnss]] in survey.toml where the records are otherwise,
    for example {"kind": "increments", "time": {"scale": "gps_week", "week": 2317}}. Records that are not given are those of the survey.
    survey: survey.toml or a dict of its keys: antenna.lever_arm, imu_spec, and what else is known. options: of trajectory.ins_gnss
    (docs/stages). Raises Error naming record and column.
    """
    _swath.check_options("trajectory.ins_gnss", json.dumps(plain(options)), "swath.smooth")
    tree = {} if survey is None else read_survey(survey)
    settings = run_table({"threads": threads, "memory": memory}, "swath.smooth")
    stages = ["readers.imu", "readers.gnss", "trajectory.ins_gnss", "python.take_trajectory"]
    with tempfile.TemporaryDirectory(prefix="swath-") as name:
        folder = Path(name)
        if imu is not None:
            default = {"kind": "rates", "angle_unit": "rad", "acceleration_unit": "m/s2", "time": {"scale": "gps"}}
            tree["imu"] = [_entry(folder / "imu.npy", _columns(imu, IMU_COLUMNS, "imu"), default, imu_format)]
        if gnss is not None:
            tree["gnss"] = [_entry(folder / "gnss.csv", _columns(gnss, GNSS_COLUMNS, "gnss"), {"angle_unit": "deg", "time": {"scale": "gps"}}, gnss_format)]
        _expect(tree, "imu", "IMU records", "swath.smooth", "give them as `imu`, or a survey that has [[imu]]")
        _expect(tree, "gnss", "GNSS positions", "swath.smooth", "give them as `gnss`, or a survey that has [[gnss]]")
        config = {"run": settings, "stage": [{"type": s, **(plain(options) if s == "trajectory.ins_gnss" else {})} for s in stages]}
        done = _swath.run({"in_memory": True, "config": "swath.smooth", "tree": json.dumps(config), "command": "swath.smooth", "bar": progress,
                           "survey": survey_file(folder, tree), "output": str(folder / "out"), "memory_beside": 0.0 if memory else MEMORY_BESIDE})
    report = report_of(json.loads(done["report"]))
    return Trajectory(done["trajectory"], report, _step(done["trajectory"]))


def read_trajectory(survey: Survey, *, max_gap: str = "0.1 s") -> Trajectory:
    """The trajectory that a survey names ([[trajectory]]: SBET with smrmsg, text), as the stage readers.trajectory reads it."""
    tree = read_survey(survey)
    _expect(tree, "trajectory", "trajectory", "swath.read_trajectory", "give a survey that has [[trajectory]]")
    config = {"stage": [{"type": "readers.trajectory", "max_gap": max_gap}, {"type": "python.take_trajectory"}]}
    with tempfile.TemporaryDirectory(prefix="swath-") as name:
        folder = Path(name)
        done = _swath.run({"in_memory": True, "config": "swath.read_trajectory", "tree": json.dumps(config), "command": "swath.read_trajectory",
                           "survey": survey_file(folder, tree), "output": str(folder / "out"), "memory_beside": MEMORY_BESIDE})
    return Trajectory(done["trajectory"], report_of(json.loads(done["report"])), _step(done["trajectory"]))


def _step(held: Any) -> float:
    """Longest step that is interpolated over, s: 2.5 of the trajectory's, as the stage has it; at least 0.1 s."""
    return max(0.1, 2.5 * float(np.median(np.diff(held.column("time")))))


def georeference(laser: Any, trajectory: Trajectory, *, crs: str | None = None, survey: Survey | None = None,
                 laser_format: Mapping[str, Any] | None = None, returns: bool = True, threads: int | None = None, memory: str | None = None,
                 progress: bool = False) -> Points:
    """Takes raw returns from the scanner's frame to the map, each at its own instant, with its uncertainty: the stage georeference.

    laser: columns time (GPS s), scan_angle (rad, positive to starboard) and range (m), or x, y, z in the scanner's frame, with intensity,
    return_number, return_count, line where known; a structured array, a mapping, or the name of a .npy file. laser_format: keys of [[laser]]
    in survey.toml where the records are otherwise. trajectory: of smooth() or read_trajectory(). survey: survey.toml or a dict of its keys:
    scanner, calibration, sigma, crs. crs: of the points, a map projection. returns: number the returns of pulses, or flag what cannot be
    (filters.returns).

    Returns Points in the order of the records, with range, incidence, sigma_h and sigma_v (m). Returns at times that the trajectory does not
    cover are left out; counts says how many.
    """
    tree = {} if survey is None else read_survey(survey)
    tree |= {"crs": crs} if crs else {}
    if not tree.get("crs"):
        raise usage_error("no CRS for the points", "swath.georeference: crs", "name a map projection, for example crs='EPSG:32632'")
    if isinstance(laser, (str, os.PathLike)):
        laser = np.load(laser)
    columns = _columns(laser, LASER_COLUMNS, "laser")
    stages = ["python.trajectory", "readers.laser", "georeference", *(["filters.returns"] if returns else []), "python.take"]
    config = {"run": run_table({"threads": threads, "memory": memory}, "swath.georeference"), "stage": [{"type": s} for s in stages]}
    takes = ["x", "y", "z", "time", "intensity", "return_number", "return_count", "classification", "flags", "scan_angle", "strip", "range",
             "incidence", "sigma_h", "sigma_v"]
    with tempfile.TemporaryDirectory(prefix="swath-") as name:
        folder = Path(name)
        default = {"angle_unit": "rad", "time": {"scale": "gps"}, **({} if "line" in columns else {"line": 1})}
        tree["laser"] = [_entry(folder / "laser.npy", columns, default, laser_format)]
        done = _swath.run({"in_memory": True, "config": "swath.georeference", "tree": json.dumps(config), "command": "swath.georeference", "bar": progress,
                           "survey": survey_file(folder, tree), "output": str(folder / "out"), "trajectory": trajectory.held,
                           "max_gap": trajectory.max_gap, "take_columns": takes, "records": len(columns["time"]),
                           "memory_beside": 0.0 if memory else MEMORY_BESIDE})
    reached = done["columns"].pop("reached").astype(bool)
    taken = {n: c if reached.all() else c[reached] for n, c in done["columns"].items()}
    counts = {key: one.count or 0 for s in report_of(json.loads(done["report"])).stages for key, one in s.tally.items()}
    return Points(las_columns(taken, {}, True, 6), done["crs"], Storage(), counts)


def simulate(folder: str | os.PathLike[str], **options: Any) -> dict[str, Any]:
    """Makes the raw records of a survey whose truth is known, as `swath simulate` does; returns what was made.

    options: those of docs/simulate.md, tables as dicts: simulate("demo", seed=7, flight={"lines": 2}, world={"scene": "forest"}).
    """
    made: dict[str, Any] = json.loads(_swath.simulate(os.fspath(folder), json.dumps(plain(options))))
    return made
