# SPDX-License-Identifier: GPL-3.0-or-later
"""Contents of the program's products, read without its own code, and how two files of one kind are compared.

Bytes: LAS, LAZ, GeoTIFF, GeoPackage, SBET, smrmsg, NumPy and whatever is not named below. Contents: JSON, GeoJSON, CSV, DXF, VRT. Drawn files
(PNG, SVG, PDF, HTML) are not compared. What is masked is in MASKED, with the reason.
"""
import csv
import fnmatch
import hashlib
import json
import re
import xml.etree.ElementTree
from pathlib import Path

DRAWN = {".png", ".svg", ".html", ".pdf"}
MASKED = {
    "LAS header, bytes 8 to 23": "the project's GUID is made from the fingerprint, which changes with names of options",
    "LAS header, bytes 26 to 57 and 58 to 89": "system identifier and generating software: name and version of the program",
    "LAS header, bytes 90 to 93": "day and year of the file's making",
    "report.json: program, versions": "version of the program and of the libraries",
    "report.json: command": "names the program's path and its output",
    "report.json: seconds, processor_seconds, of stages too": "time that the run took",
    "report.json: threads, pieces_resumed": "what the machine did, not what it found",
    "report.json: fingerprint": "made from the names of options and the version",
    "report.json: from (line and column)": "moves when a comment of a config changes",
}
DXF_TOLERANCE = 0.6e-4      # metres: coordinates are written with four decimals
GEOJSON_TOLERANCE = 0.6e-9  # degrees: nine decimals
DEGREE_DIGITS = 6           # digits by which features are put in order
LAS_MASKS = ((8, 24), (26, 90), (90, 94))


def kind_of(name):
    name = name.lower()
    for kind in ("geojson", "json", "csv", "dxf", "vrt"):
        if name.endswith("." + kind):
            return kind
    return "drawn" if any(name.endswith(d) for d in DRAWN) else "bytes"


def digest(file):
    """SHA-256 of a file, what is masked set to zero."""
    data = file.read_bytes()
    if data[:4] == b"LASF":
        data = bytearray(data)
        for begin, end in LAS_MASKS:
            data[begin:end] = bytes(end - begin)
    return hashlib.sha256(data).hexdigest()


class Renamed:
    """The table of --renamed. A line is `[file:]old new`: a key, or a path of keys from the file's root with `/` between them. `*` stands for any one key; `-`
    in place of a name: a key that is new or that went. What lies below a renamed key moves with it. # begins a comment."""

    def __init__(self, file=None):
        self.rules, self.used = [], set()
        for line in Path(file).read_text(encoding="utf-8").splitlines() if file else []:
            words = line.split("#")[0].split()
            if not words:
                continue
            if len(words) != 2:
                raise SystemExit(f"{file}: not two names: {line}")
            where, _, old = words[0].rpartition(":")
            self.rules.append((where or "*", old.split("/"), words[1].split("/")))

    @staticmethod
    def _fits(rule, path):
        return len(path) >= len(rule) and all(r in ("*", p) for r, p in zip(rule, path))

    def old_path(self, file, path):
        """Where a value of the old product is to be found in the new one; None: it went."""
        for at, (where, old, new) in enumerate(self.rules):
            if old == ["-"] or not fnmatch.fnmatch(file, where):
                continue
            if len(old) == 1 and old[0] in path:
                self.used.add(at)
                if new == ["-"]:
                    return None
                path = tuple(new[0] if p == old[0] else p for p in path)
            elif len(old) > 1 and self._fits(old, path):
                self.used.add(at)
                if new == ["-"]:
                    return None
                stars = iter(p for r, p in zip(old, path) if r == "*")
                path = tuple(next(stars) if n == "*" else n for n in new) + path[len(old):]
        return path

    def is_new(self, file, path):
        for at, (where, old, new) in enumerate(self.rules):
            if old == ["-"] and fnmatch.fnmatch(file, where) and (self._fits(new, path) if len(new) > 1 else new[0] in path):
                self.used.add(at)
                return True
        return False

    def unused(self):
        return [f"{w}:{'/'.join(o)} {'/'.join(n)}" for at, (w, o, n) in enumerate(self.rules) if at not in self.used]


def flat(value, path=()):
    """(path, value) of every leaf. Stages of a report are named by their type, so that one more stage moves no other."""
    if isinstance(value, dict) and value:
        for key, v in value.items():
            yield from flat(v, (*path, key))
    elif isinstance(value, list) and value:
        seen = {}
        for k, v in enumerate(value):
            name = str(k)
            if path == ("stages",) and isinstance(v, dict) and "type" in v:
                seen[v["type"]] = seen.get(v["type"], 0) + 1
                name = v["type"] + (f"#{seen[v['type']]}" if seen[v["type"]] > 1 else "")
            yield from flat(v, (*path, name))
    else:
        yield path, value


def is_masked(file, path):
    if not file.endswith("report.json"):
        return False
    return (path[0] in ("program", "versions", "command", "seconds", "processor_seconds", "threads", "pieces_resumed") or path[-1] == "fingerprint" or
            path[0] == "stages" and path[2:] in (("seconds",), ("processor_seconds",)))


def plain(path, value):
    """A value as it is compared: the place of an option without line and column."""
    return re.sub(r":\d+:\d+$", "", value) if path[-1:] == ("from",) and isinstance(value, str) else value


def is_sentence(value):
    return isinstance(value, str) and len(value.split()) > 2


def same_number(a, b, tolerance=0.0):
    return a == b or isinstance(a, (int, float)) and isinstance(b, (int, float)) and abs(a - b) <= tolerance


def compare_values(file, old, new, renamed, sentences_may_differ):
    """Differences of two trees, as lines."""
    found = dict(flat(new))
    moved = {}
    out = []
    for path, value in flat(old):
        if is_masked(file, path):
            continue
        to = renamed.old_path(file, path)
        if to is not None:
            moved[to] = (path, value)
    for to, (path, value) in moved.items():
        if to not in found:
            out.append(f"{'/'.join(path)} = {shown(value)} is missing in the new" + (f" as {'/'.join(to)}" if to != path else ""))
            continue
        a, b = plain(path, value), plain(to, found[to])
        if sentences_may_differ and is_sentence(a) and is_sentence(b):
            continue
        if type(a) is bool or type(b) is bool or not same_number(a, b):
            if a is not b:
                out.append(f"{'/'.join(path)}: {shown(a)} before, {shown(b)} now")
    out += [f"{'/'.join(path)} = {shown(value)} is new" for path, value in found.items()
            if path not in moved and not is_masked(file, path) and not renamed.is_new(file, path)]
    return out


def shown(value):
    text = json.dumps(value)
    return text if len(text) < 90 else text[:87] + "..."


def tree_of_csv(file):
    with open(file, newline="", encoding="utf-8") as text:
        rows = list(csv.reader(text))
    head = rows[0] if rows else []
    return {name: {str(k): number(row[c]) if c < len(row) else None for k, row in enumerate(rows[1:])} for c, name in enumerate(head)}


def number(text):
    try:
        return float(text)
    except ValueError:
        return text.strip()


# --- features: (kind, attributes, coordinates)

def rounded(feature, digits):
    kind, attributes, coordinates = feature
    return kind, json.dumps(attributes, sort_keys=True), [round(c, digits) for c in coordinates]


def compare_features(old, new, tolerance, digits):
    if len(old) != len(new):
        return [f"{len(old)} features before, {len(new)} now"]
    old, new = (sorted(side, key=lambda f: rounded(f, digits)) for side in (old, new))
    out = []
    for k, ((kind, attributes, at), (kind_new, attributes_new, at_new)) in enumerate(zip(old, new)):
        if (kind, attributes) != (kind_new, attributes_new):
            out.append(f"feature {k}: {kind} {shown(attributes)} before, {kind_new} {shown(attributes_new)} now")
        elif len(at) != len(at_new):
            out.append(f"feature {k}, {kind} {shown(attributes)}: {len(at)} coordinates before, {len(at_new)} now")
        elif any(abs(a - b) > tolerance for a, b in zip(at, at_new)):
            out.append(f"feature {k}, {kind} {shown(attributes)}: off by {max(abs(a - b) for a, b in zip(at, at_new)):.3g}")
    return out


def geojson_of(file):
    data = json.loads(file.read_text(encoding="utf-8"))

    def numbers(c):
        return [x for v in c for x in numbers(v)] if isinstance(c, list) else [c]
    features = [(f["geometry"]["type"], f["properties"], numbers(f["geometry"]["coordinates"])) for f in data.pop("features", [])]
    return features, data


def groups_of_dxf(file):
    lines = iter(file.read_text(encoding="utf-8", errors="replace").splitlines())
    return [(int(code), value.strip()) for code, value in zip(lines, lines)]


def dxf_of(file):
    """Entities of a drawing: lines of either kind with their vertices, points, texts with place, height and rotation."""
    groups = groups_of_dxf(file)
    begin = groups.index((2, "ENTITIES"))
    entities = []
    for code, value in groups[begin + 1:]:
        if code == 0:
            if value == "ENDSEC":
                break
            entities.append((value, []))
        elif entities:
            entities[-1][1].append((code, value))
    out = []
    for kind, values in entities:
        first = dict(reversed(values))
        place = [[float(v) for c, v in values if c == axis] for axis in (10, 20, 30)]
        if kind == "VERTEX":
            out[-1][2].extend(p[0] for p in place if p)
        elif kind == "LWPOLYLINE":
            heights = [float(first.get(38, 0))] * len(place[0])
            closed = int(first.get(70, 0)) & 1
            out.append(("line", {"layer": first.get(8), "closed": closed}, [c for xyz in zip(*place[:2], heights) for c in xyz]))
        elif kind == "POLYLINE":
            out.append(("line", {"layer": first.get(8), "closed": int(first.get(70, 0)) & 1}, []))
        elif kind in ("TEXT", "MTEXT"):
            out.append(("text", {"layer": first.get(8), "text": first.get(1), "size": float(first.get(40, 0)), "rotation": float(first.get(50, 0))},
                        [p[0] for p in place if p]))
        elif kind != "SEQEND":
            out.append((kind.lower(), {"layer": first.get(8)}, [p[0] for p in place if p]))
    return out


def vrt_of(file):
    """A mosaic as a tree: size, place, system, and for each band its name, unit, nodata and sources by file."""
    root = xml.etree.ElementTree.parse(file).getroot()
    text = lambda at, name: " ".join((at.findtext(name) or "").split())  # noqa: E731
    tree = {"size": dict(root.attrib), "system": re.sub(r"\s+", "", text(root, "SRS")), "place": [float(v) for v in text(root, "GeoTransform").split(",")]}
    for band in root.findall("VRTRasterBand"):
        sources = {}
        for source in band:
            if source.tag.endswith("Source"):
                rectangles = {r: {k: float(v) for k, v in source.find(r).attrib.items()} for r in ("SrcRect", "DstRect") if source.find(r) is not None}
                sources[text(source, "SourceFilename")] = {"band": text(source, "SourceBand"), "nodata": number(text(source, "NODATA")), **rectangles}
        tree[f"band {band.get('band')}"] = {"type": band.get("dataType"), "name": text(band, "Description"), "unit": text(band, "UnitType"),
                                            "nodata": number(text(band, "NoDataValue")), "sources": sources}
    return tree


def compare(name, old, new, renamed, sentences_may_differ=False):
    """Differences of two files that are compared by content, as lines."""
    kind = kind_of(name)
    if old.read_bytes() == new.read_bytes():
        return []
    if kind == "geojson":
        (a, rest_a), (b, rest_b) = geojson_of(old), geojson_of(new)
        return compare_features(a, b, GEOJSON_TOLERANCE, DEGREE_DIGITS) + compare_values(name, rest_a, rest_b, renamed, sentences_may_differ)
    if kind == "dxf":
        return compare_features(dxf_of(old), dxf_of(new), DXF_TOLERANCE, 3)
    read = {"json": lambda f: json.loads(f.read_text(encoding="utf-8")), "csv": tree_of_csv, "vrt": vrt_of}[kind]
    return compare_values(name, read(old), read(new), renamed, sentences_may_differ)
