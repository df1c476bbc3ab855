# SPDX-License-Identifier: GPL-3.0-or-later
"""A survey that can be changed: survey.toml as a tree, its records as arrays. What is changed is written beside the copy of survey.toml,
what is not is named by its absolute path."""
import csv
import json
import pathlib
import tomllib

import numpy as np

SBET = ("time", "latitude", "longitude", "height", "vx", "vy", "vz", "roll", "pitch", "heading", "wander", "ax", "ay", "az", "p", "q", "r")
SMRMSG = ("time", "sn", "se", "sd", "svn", "sve", "svd", "sroll", "spitch", "sheading")
COLUMN = {name: k for k, name in enumerate(SBET)}


class NotApplicable(Exception):
    """The mistake has no meaning in this survey (another scanner, no control)."""


def toml_value(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml_value, value)) + "]"
    return json.dumps(value)


def toml_text(tree, path=""):
    plain = {k: v for k, v in tree.items() if not isinstance(v, dict) and not (isinstance(v, list) and v and isinstance(v[0], dict))}
    text = "".join(f"{k} = {toml_value(v)}\n" for k, v in plain.items()) + "\n"
    for key, value in tree.items():
        if key in plain:
            continue
        name = f"{path}.{key}" if path else key
        for table in value if isinstance(value, list) else [value]:
            text += (f"[[{name}]]\n" if isinstance(value, list) else f"[{name}]\n") + toml_text(table, name)
    return text


def number(text):
    """Number of "0.05 deg", in the unit that is written there."""
    return float(str(text).split()[0])


class Survey:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder).resolve()
        self.tree = tomllib.loads((self.folder / "survey.toml").read_text())
        self.tree.pop("truth", None)  # nothing of the run may see it
        self.changed = {}  # file -> writer
        self.arrays = {}

    def __getitem__(self, key):
        """A table of survey.toml; of a list of tables the first."""
        if key not in self.tree:
            raise NotApplicable(key)
        value = self.tree[key]
        return value[0] if isinstance(value, list) and key not in ("line", "control") else value

    def text_table(self, key):
        file = self[key]["file"]
        if file not in self.arrays:
            with open(self.folder / file) as source:
                names = source.readline().strip().split(",")
            self.arrays[file] = names, np.loadtxt(self.folder / file, delimiter=",", skiprows=1)
            self.changed[file] = lambda target: np.savetxt(target, self.arrays[file][1], "%.13g", ",", header=",".join(names), comments="")
        return self.arrays[file]

    def column(self, key, name):
        """A view of one column of a text file (imu, gnss) by the name that survey.toml gives to the column of the program."""
        names, table = self.text_table(key)
        return table[:, names.index(self[key]["columns"][name])]

    def laser(self):
        file = self["laser"]["file"]
        if not file.endswith(".npy"):
            raise NotApplicable("records in NumPy files alone are changed")
        if file not in self.arrays:
            self.arrays[file] = np.load(self.folder / file)
            self.changed[file] = lambda target: np.save(target, self.arrays[file])
        return self.arrays[file]

    def set_laser(self, table):
        self.laser()
        self.arrays[self["laser"]["file"]] = table

    def laser_column(self, name):
        columns = self["laser"]["columns"]
        if name not in columns:
            raise NotApplicable(f"no column {name}")
        return self.laser()[columns[name]]

    def scale_ranges(self, factor):
        for name in ("range",) if "range" in self["laser"]["columns"] else ("x", "y", "z"):
            self.laser_column(name)[:] *= factor

    def binary(self, file, width):
        if file not in self.arrays:
            self.arrays[file] = np.fromfile(self.folder / file).reshape(-1, width)
            self.changed[file] = lambda target: self.arrays[file].tofile(target)
        return self.arrays[file]

    def sbet(self, name=None):
        table = self.binary(self["trajectory"]["file"], len(SBET))
        return table if name is None else table[:, COLUMN[name]]

    def smrmsg(self):
        return self.binary(self["trajectory"]["accuracy"], len(SMRMSG))

    def text_trajectory(self, table, units):
        """Puts the delivered trajectory as text in place of the SBET: columns by name, angles in `units`."""
        self.changed["trajectory.csv"] = lambda target: np.savetxt(target, np.column_stack(list(table.values())), "%.11f", ",",
                                                                   header=",".join(table), comments="")
        time = self["trajectory"]["time"]
        self.tree["trajectory"] = [{"file": "trajectory.csv", "format": "text", "angle_unit": units, "time": time,
                                    "columns": {name: name for name in table}}]

    def control_rows(self, edit):
        """Applies `edit` to every row (a dict of texts) of every control file."""
        for control in self["control"]:
            with open(self.folder / control["file"], newline="") as source:
                rows = list(csv.DictReader(source))
            for row in rows:
                edit(row)

            def write(target, rows=rows):
                with open(target, "w", newline="") as out:
                    writer = csv.DictWriter(out, rows[0].keys())
                    writer.writeheader()
                    writer.writerows(rows)

            self.changed[control["file"]] = write

    def save(self, folder):
        folder.mkdir(parents=True, exist_ok=True)
        for file, write in self.changed.items():
            write(folder / file)
        for table in (t for v in self.tree.values() if isinstance(v, list) for t in v):
            for key in ("file", "accuracy"):
                if key in table and table[key] not in self.changed:
                    table[key] = str(self.folder / table[key])
        (folder / "survey.toml").write_text(toml_text(self.tree))
        return folder / "survey.toml"
