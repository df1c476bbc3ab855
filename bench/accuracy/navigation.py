# SPDX-License-Identifier: GPL-3.0-or-later
"""What the trajectory scripts share: SBET, smrmsg and covariances read by NumPy, and errors of a smoothed trajectory against its truth."""
import json

import numpy as np

import common

STAGES = [{"type": t} for t in ("readers.imu", "readers.gnss", "trajectory.ins_gnss", "writers.trajectory")]
AXES = ("north", "east", "down", "roll", "pitch", "heading")
ARCSEC = np.pi / 180 / 3600
A, E2 = 6378137.0, 0.0066943799901413165  # WGS84


def sbet(file):
    """Columns of an SBET: time, latitude, longitude, height, v (3, wander frame), roll, pitch, platform heading, wander, ..."""
    return np.fromfile(file, "<f8").reshape(-1, 17)


def sigmas(file):
    """Columns of a smrmsg: time, then the sigmas of north east down m, velocities m/s, roll pitch heading rad."""
    table = np.fromfile(file, "<f8").reshape(-1, 10)
    table[:, 7:10] *= np.pi / 180 / 60
    return table


def wrapped(angle):
    return (angle + np.pi) % (2 * np.pi) - np.pi


def radii(latitude, height):
    """Metres per radian of latitude and of longitude."""
    w = np.sqrt(1 - E2 * np.sin(latitude) ** 2)
    return A * (1 - E2) / w**3 + height, (A / w + height) * np.cos(latitude)


def heading(table):
    """True heading: platform heading less the wander angle."""
    return table[:, 9] - table[:, 10]


def velocity(table):
    """Velocity north, east, down; the wander angle is 0 in the files of both sides."""
    if np.any(table[:, 10]):
        raise SystemExit("an SBET with a wander angle")
    return table[:, 4:7] * [1, -1, -1]


def errors(flown, truth):
    """Trajectory minus truth, both SBETs: n x 6, north east down m, roll pitch heading rad, at the trajectory's records within the truth."""
    inside = (flown[:, 0] >= truth[0, 0] - 1e-6) & (flown[:, 0] <= truth[-1, 0] + 1e-6)
    flown = flown[inside]
    at = lambda column: np.interp(flown[:, 0], truth[:, 0], column)
    lat, lon, h = at(truth[:, 1]), at(truth[:, 2]), at(truth[:, 3])
    north, east = radii(lat, h)
    turned = np.interp(flown[:, 0], truth[:, 0], np.unwrap(heading(truth)))
    out = np.stack([(flown[:, 1] - lat) * north, (flown[:, 2] - lon) * east, h - flown[:, 3], flown[:, 7] - at(truth[:, 7]),
                    flown[:, 8] - at(truth[:, 8]), heading(flown) - turned], axis=1)
    out[:, 3:] = wrapped(out[:, 3:])
    return flown[:, 0], out, inside


def nees(output, flown, truth, spans):
    """Mean normalised squared error (9 degrees of freedom: position, velocity, attitude) of the smoother's nodes within the spans."""
    time, error, inside = errors(flown, truth)
    drift = velocity(flown[inside]) - np.stack([np.interp(time, truth[:, 0], v) for v in velocity(truth).T], axis=1)
    error = np.concatenate([error[:, :3], drift, error[:, 3:]], axis=1)
    nodes, covariance = covariances(output / "trajectory_covariance.csv")
    good = within(nodes, spans) & (nodes >= time[0]) & (nodes <= time[-1])
    here = np.stack([np.interp(nodes[good], time, e) for e in error.T], axis=1)
    return np.mean(np.einsum("ni,ni->n", here, np.linalg.solve(covariance[good], here[..., None])[..., 0]))


def within(time, spans):
    return np.any([(time >= a) & (time <= b) for a, b in spans], axis=0)


def covariances(file):
    """Seconds of week and the 9 x 9 covariances of a *_covariance.csv: position, velocity, roll pitch heading (m, m/s, rad)."""
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    full = np.zeros((len(table), 9, 9))
    full[:, *np.triu_indices(9)] = table[:, 2:]
    return table[:, 1], full + np.triu(full, 1).transpose(0, 2, 1)


def findings(output):
    return json.loads((output / "trajectory.json").read_text())


def measures(error, sigma):
    """rms of the six components (cm, arcsec) and the mean squares of error over sigma."""
    unit = np.array([0.01] * 3 + [ARCSEC] * 3)
    return common.rms(error) / unit, np.mean(np.square(error / sigma), axis=0)


def pooled(squares):
    """Root of the mean over runs of mean squares, with its standard error, as texts."""
    squares = np.asarray(squares)
    mean = squares.mean(axis=0)
    spread = squares.std(axis=0, ddof=1) / np.sqrt(len(squares)) / (2 * np.sqrt(mean)) if len(squares) > 1 else np.zeros_like(mean)
    return " ".join(f"{np.sqrt(m):.2f}±{s:.2f}" for m, s in zip(mean, spread))


def ranges(values, digits=2):
    """Mean (smallest to largest) over runs of each column, as text."""
    values = np.asarray(values)
    return ", ".join(f"{v.mean():.{digits}f} ({v.min():.{digits}f}-{v.max():.{digits}f})" for v in values.T)
