# SPDX-License-Identifier: GPL-3.0-or-later
"""One run of the program and what became of it: exit, messages, geometry's verdict, errors of the points."""
import json
import os
import re
import resource
import subprocess
import threading
import time
from dataclasses import dataclass, field

import numpy as np

ADDRESS_SPACE = 12 << 30  # bytes: a run that wants more ends, not the machine
OUTLIERS = (7, 18)
RUN_COUNTS = re.compile(r"^(filters|terrain|writers|report|quality)\.")  # counts of what was done, no judgement of the records
FOLDERS = re.compile(r"(?<!\w)/(?:[^\s/:]+/)+")  # of absolute paths: they hold the mistake's own name
PLAIN_COUNTS = re.compile(r"^(GNSS fixes: |SBET files with velocities|((first|last|only|intermediate) returns|pulses of \d+ returns?)$|CSD pulses between|(cells|facets|planes)\b)")


@dataclass
class Run:
    code: int = 0
    hung: bool = False
    seconds: float = 0.0
    cpu: float = 0.0
    stderr: str = ""
    report: dict = field(default_factory=dict)


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))


def execute(words, limit):
    begin = time.monotonic()
    with subprocess.Popen(list(map(str, words)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, preexec_fn=limit_memory) as process:
        hung = threading.Event()
        timer = threading.Timer(limit, lambda: (hung.set(), process.kill()))
        timer.start()
        stderr = process.stderr.read()
        _, status, used = os.wait4(process.pid, 0)
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
    return Run(process.returncode, hung.is_set(), time.monotonic() - begin, used.ru_utime + used.ru_stime, stderr.strip())


def run(program, config, survey, output, limit, options=()):
    sets = [word for option in ("las.compress=false", *options) for word in ("--set", option)]
    done = execute([program, "run", config, "--survey", survey, "--output", output, "--quiet", "--threads", 1, *sets], limit)
    report = output / "report.json"
    if report.exists() and done.code in (0, 3):
        done.report = json.loads(report.read_text())
    return done


def geometry(report):
    """The sanity gate's result: of the report itself or of a stage's findings; empty where there is none."""
    places = [report, *(stage.get("findings") or {} for stage in report.get("stages", []))]
    for place in places:
        if isinstance(place.get("geometry"), dict):
            return place["geometry"]
    for stage in report.get("stages", []):
        if "verdict" in (stage.get("findings") or {}) and "geometry" in stage["type"]:
            return stage["findings"]
    return {}


def gate_seconds(report):
    stages = [s for s in report.get("stages", []) if "geometry" in s["type"]]
    return sum(s["seconds"] for s in stages) or geometry(report).get("seconds", 0.0)


def identifiers(named):
    """Identifiers of `named`, which is a text, a list of texts or of tables with an id."""
    if isinstance(named, str):
        return [named] if named else []
    if isinstance(named, dict):
        return [named[key] for key in ("id", "name", "named", "mistake", "cause") if isinstance(named.get(key), str)][:1]
    return [i for one in named or [] for i in identifiers(one)]


def texts(value):
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for v in value.values():
            yield from texts(v)
    elif isinstance(value, list):
        for v in value:
            yield from texts(v)


def sentences(findings, inside=False):
    """Texts of the lists named warnings, findings, advice; judgements for a person."""
    if isinstance(findings, dict):
        for key, value in findings.items():
            yield from sentences(value, inside or key in ("warnings", "findings", "advice", "notes", "messages"))
    elif isinstance(findings, list):
        for value in findings:
            yield from sentences(value, inside)
    elif inside and isinstance(findings, str):
        yield findings


def messages(done, of_gate=True):
    """{message without its numbers: message} of a run that ended, without the counts of what was done; `of_gate`: with those of geometry."""
    found = done.stderr.splitlines()
    for stage in done.report.get("stages", []):
        if "geometry" in stage["type"] and not of_gate:
            continue
        judged = geometry({"stages": [stage]}) if "geometry" in stage["type"] else stage.get("findings")
        if not RUN_COUNTS.match(stage["type"]) or "geometry" in stage["type"]:
            found += sentences(judged)
            found += [w for w in stage.get("tally") or {} if not PLAIN_COUNTS.match(w)]
    found += sentences(done.report.get("geometry")) if of_gate else []
    found += sentences({k: v for k, v in done.report.items() if k in ("warnings", "notes")})
    found = [FOLDERS.sub("", text) for text in found]
    return {re.sub(r"-?[\d.]+(e[-+]?\d+)?", "#", text): text for text in found}


def las_points(folder):
    """Time, return number and place of all points of a run's LAS 1.4 files (format 6 and above)."""
    parts = []
    for file in sorted((folder / "points").glob("*.las")):
        raw = file.read_bytes()
        start = int.from_bytes(raw[96:100], "little")
        length, count = int.from_bytes(raw[105:107], "little"), int.from_bytes(raw[247:255], "little")
        scale, offset = np.frombuffer(raw, "<f8", 3, 131), np.frombuffer(raw, "<f8", 3, 155)
        point = np.dtype({"names": ["xyz", "returns", "time"], "formats": ["3<i4", "u1", "<f8"], "offsets": [0, 14, 22], "itemsize": length})
        points = np.frombuffer(raw, point, count, start)
        parts.append((points["time"], points["returns"] & 15, points["xyz"] * scale + offset))
    if not parts:
        return np.empty(0), np.empty(0, int), np.empty((0, 3))
    return tuple(np.concatenate([part[k] for part in parts]) for k in range(3))


def true_error(output, truth, shift=0.0):
    """3D rms of the points against their true places, m, paired by time (records are `shift` s late) and return number; NaN without pairs."""
    time, returns, place = las_points(output)
    if len(time) == 0:
        return np.nan
    zero = truth["t"][0]
    pulse, inverse = np.unique(truth["t"] - zero, return_inverse=True)
    key = inverse * 16 + truth["rn"]
    order = np.argsort(key)
    # LAS times count from 1e9 s after the first of GPS's seconds, and only so where the survey's week is right.
    mine = time - (zero - 1e9) - shift
    at = np.clip(np.searchsorted(pulse, mine), 1, len(pulse) - 1)
    at -= mine - pulse[at - 1] < pulse[at] - mine
    wanted = at * 16 + returns
    row = order[np.minimum(np.searchsorted(key[order], wanted), len(key) - 1)]
    good = (np.abs(pulse[at] - mine) < 4e-6) & (key[row] == wanted) & ~np.isin(truth["cls"][row], OUTLIERS)
    if good.sum() < 1000:
        return np.nan
    true = np.stack([truth[name][row[good]] for name in "enh"], axis=1)
    return float(np.sqrt(np.mean(np.sum((place[good] - true) ** 2, axis=1))))
