# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes what the package has of the stages' declarations: classes of reports (_report_types.py) and stubs (*.pyi).

generate.py PACKAGE   (the folder swath with the built module; run by the build)
"""
import json
import keyword
import re
import sys
import textwrap
import types
from pathlib import Path

package = Path(sys.argv[1]).resolve()
# The package itself cannot be imported before its classes are there.
swath = types.ModuleType("swath")
swath.__path__ = [str(package)]
sys.modules["swath"] = swath
from swath import _functions, _swath  # noqa: E402

LICENCE = "# SPDX-License-Identifier: GPL-3.0-or-later\n# Made by generate.py.\n"
TAKEN = ("others", "float", "int", "str", "bool", "list", "dict", "field", "tree")  # names of the classes' own
SCALARS = {"integer": "int", "number": "float", "string": "str", "boolean": "bool"}


def identifier(key):
    name = re.sub(r"\W", "_", key)
    return f"{name}_" if keyword.iskeyword(name) or name in TAKEN else f"_{name}" if name[:1].isdigit() else name


def class_name(*parts):
    return "".join(p[:1].upper() + p[1:] for part in parts for p in re.split(r"\W|_", part) if p)


class Classes:
    """Dataclasses of a JSON schema; inner ones come before those that hold them."""

    def __init__(self):
        self.text = []
        self.names = set()

    def type_of(self, schema, name):
        kind = schema.get("type")
        if "anyOf" in schema:
            kinds = [self.type_of(s, name) for s in schema["anyOf"]]
            return " | ".join(dict.fromkeys(kinds))
        if isinstance(kind, list):
            return " | ".join(SCALARS[k] for k in kind if k != "null")
        if "enum" in schema or "const" in schema:
            return "str"
        if kind == "array":
            return f"list[{self.type_of(schema['items'], name) if 'items' in schema else 'Any'}]"
        if kind == "object" and "additionalProperties" in schema and schema["additionalProperties"] not in (True, False):
            return f"dict[str, {self.type_of(schema['additionalProperties'], name)}]"
        if kind == "object" and schema.get("properties"):
            return self.add(name, schema["properties"], schema.get("description", ""))
        if kind == "object" or kind is None:
            return "Any"
        return SCALARS[kind]

    def add(self, name, properties, doc, base="", types_of=None, first=""):
        while name in self.names:
            name += "_"
        self.names.add(name)
        fields = []
        for key, one in properties.items():
            kind = (types_of or {}).get(key) or self.type_of(one, class_name(name, key))
            extra = f", metadata={{'key': {key!r}}}" if identifier(key) != key else ""
            fields.append(f"    {identifier(key)}: {kind} | None = field(default=None{extra})\n")
            fields.append(textwrap.indent(textwrap.fill(f'"""{one.get("description", "").strip()}"""', 130), "    ") + "\n")
        head = f"@dataclass(repr=False)\nclass {name}{base}:\n    " + textwrap.fill(f'"""{doc or name}"""', 130, subsequent_indent="    ") + "\n\n"
        others = "" if base else "    others: dict[str, Any] = field(default_factory=dict)\n    \"\"\"Keys that this version does not declare.\"\"\"\n"
        self.text.append(head + first + "".join(fields) + others + ("" if fields or others or first else "    pass\n"))
        return name


REPORT_TAIL = '''
    stages: list[Stage] = field(default_factory=list)
    """The stages in their order."""
    tree: dict[str, Any] = field(default_factory=dict)
    """The report as report.json holds it."""

    @property
    def missed(self) -> list[str]:
        """Names of the limits of quality that were set and missed; not those that no stage judged."""
        return [str(one["name"]) for one in self.tree.get("limits", []) if one.get("held") is False]

    def stage(self, type: str) -> Stage:
        """The (first) stage of a type, "terrain.dtm"; raises KeyError where the run had none."""
        for one in self.stages:
            if one.type == type:
                return one
        raise KeyError(type)
'''


def report_types():
    schema = json.loads(_swath.schema())["$defs"]["report"]
    c = Classes()
    count = c.add("Count", {"count": {"type": "integer", "description": "Number of records."},
                            "lines": {"type": "array", "description": "The count by flight line."},
                            "files": {"type": "array", "description": "The count by file, with times."},
                            "examples": {"type": "array", "items": {"type": "string"}, "description": "The first of them."}},
                  "A count under `tally` of a stage.")
    every = schema["properties"]["stages"]["items"]["anyOf"]
    common = {k: v for k, v in every[0]["properties"].items() if k not in ("type", "tally", "findings")}
    tally = f'    type: str = ""\n    """The stage."""\n    tally: dict[str, {count}] = field(default_factory=dict)\n    """Counts, each with its first examples."""\n'
    c.add("Stage", common, "What a stage reports.", first=tally + '    findings: Any = None\n    """What the stage found."""\n')
    table = []
    for s in every:
        name = s["properties"]["type"]["const"]
        findings = s["properties"]["findings"]
        if not findings.get("properties"):
            continue
        kind = c.type_of(findings, class_name(name, "findings"))
        stage = c.add(class_name(name, "stage"), {}, f"What {name} reports.", base="(Stage)",
                      first=f'    findings: {kind} | None = None\n    """What the stage found."""\n')
        table.append(f"    {name!r}: {stage},\n")
    rest = {k: v for k, v in schema["properties"].items() if k != "stages"}
    c.add("Report", rest, "report.json of a run.", first=REPORT_TAIL.lstrip("\n"))
    shown = ("\n\ndef _shown(self: Any) -> str:\n    values = {k: v for k, v in vars(self).items() if v is not None and v != {} and k != 'tree'}\n"
             "    return f\"{type(self).__name__}({', '.join(f'{k}={v!r}' for k, v in values.items())})\"\n\n\n")
    classes = "\n\n".join(t.replace("@dataclass(repr=False)\nclass ", "@dataclass(repr=False)\nclass ") for t in c.text)
    reprs = "for _kind in (" + ", ".join(sorted(c.names)) + "):\n    _kind.__repr__ = _shown  # type: ignore[method-assign]\n"
    return (LICENCE + '"""Classes of report.json."""\n\nfrom __future__ import annotations\n\nfrom dataclasses import dataclass, field\nfrom typing import Any\n\n\n'
            + classes + "\n\nSTAGES: dict[str, type[Stage]] = {\n" + "".join(table) + "}\n" + shown + reprs)


def option_type(option, schema):
    """The type of an option as Python gives it."""
    if option["is_table"]:
        return "Mapping[str, Any]"
    one = schema.get("properties", {}).get(option["path"], {})
    kinds = one.get("type")
    if kinds == "array" or "items" in one:
        return "Sequence[Any]"
    if "enum" in one:
        return "Literal[" + ", ".join(repr(e) for e in one["enum"]) + "]"
    kinds = kinds if isinstance(kinds, list) else [kinds]
    return " | ".join(SCALARS[k] for k in kinds if k in SCALARS) or "Any"


def function_stub(d):
    name = _functions.short_name(d["name"])
    lines = [f"def {name}(points: PointsLike, /, *"]
    for o in _functions.options_of(d):
        path = o["path"].removesuffix("[]")
        lines.append(f"{path}: {option_type(o, d['schema'])} | None = ...")
    lines += [f"{g}: Mapping[str, Any] | None = ..." for g in _functions.givers_of(d)]
    lines.append("trajectory: Trajectory" + ("" if _functions.needs_trajectory(d) else " | None = ..."))
    lines += ["survey: Mapping[str, Any] | None = ...", "threads: int | None = ...", "memory: str | None = ...", "tile: str | None = ...", "progress: bool = ..."]
    doc = _functions.docstring(d).replace("\\", "\\\\")
    return ",\n        ".join(lines) + f") -> {_functions.result_type(d)}:\n    \"\"\"{doc}\"\"\"\n"


def function_stubs():
    head = ("from collections.abc import Callable, Mapping, Sequence\nfrom typing import Any, Literal\n\nfrom ._columns import Array\nfrom ._flight import Trajectory\n"
            "from ._points import Points\nfrom ._surfaces import Contours, Grid\n\nPointsLike = Points | Array | Mapping[str, Any]\n"
            "FUNCTIONS: dict[str, Callable[..., Any]]\n\n")
    return LICENCE + head + "\n".join(function_stub(d) for d in _functions.stages_on_points())


def package_stub():
    """The package's own names, and those of the functions."""
    text = (package / "__init__.py").read_text(encoding="utf-8")
    imports = re.findall(r"^from (\.\w+) import ([\w, ]+)$", text, re.M)
    each = lambda names: ', '.join(n if ' as ' in n else f'{n} as {n}' for n in names.split(', '))
    lines = [f"from {module} import {each(names)}\n" for module, names in imports if module not in ("._functions", "._swath")]
    lines += [f"from ._functions import {name} as {name}\n" for name in sorted(_functions.FUNCTIONS)]
    return LICENCE + "".join(lines) + "\n__version__: str\n"


MODULE = '''
from typing import Any

version: str
las_columns: list[tuple[str, str]]

class HeldTrajectory:
    def column(self, name: str) -> Any: ...
    def size(self) -> int: ...

def read_points(files: list[str], wanted: list[str] | None, threads: int) -> tuple[dict[str, Any], str]: ...
def write_points(file: str, columns: dict[str, Any], about: str, crs: str, threads: int) -> None: ...
def arrow_schema(columns: dict[str, Any]) -> Any: ...
def arrow_array(columns: dict[str, Any]) -> tuple[Any, Any]: ...
def arrow_stream(columns: dict[str, Any]) -> Any: ...
def run(request: dict[str, Any]) -> dict[str, Any]: ...
def explain(request: dict[str, Any]) -> str: ...
def resident_bytes() -> int: ...
def stages() -> str: ...
def schema() -> str: ...
def check_options(stage: str, options: str, path: str) -> None: ...
def write_raster(file: str, names: list[str], bands: list[Any], cell: float, west: float, north: float, unit: str, crs: str) -> None: ...
def read_raster(file: str, band: int) -> tuple[Any, list[float], str, str, str, int]: ...
def write_contours(file: str, lines: list[tuple[Any, Any, float, bool, bool, bool]], crs: str) -> None: ...
def simulate(folder: str, options: str) -> str: ...
def describe_file(file: str) -> str: ...
def use_proj_folders(folders: list[str]) -> None: ...
'''

for name, text in {"_report_types.py": report_types(), "_functions.pyi": function_stubs(), "__init__.pyi": package_stub(),
                   "_swath.pyi": LICENCE + MODULE}.items():
    (package / name).write_text(text, encoding="utf-8")
