# SPDX-License-Identifier: GPL-3.0-or-later
"""A calibration's report.html as tables and texts, and the numbers that its cells show."""
import html.parser
import math

MISSING = "–"


class Page(html.parser.HTMLParser):
    """Tables by id as (heads, rows), the other texts, the files that captions name."""

    def __init__(self, text):
        super().__init__()
        self.tables, self.paragraphs, self.items, self.codes = {}, [], [], []
        self.verdict = None
        self.table, self.cell, self.within = None, None, None
        self.skip = 0
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "table":
            self.table = ([], [])
            self.tables[attributes.get("id", f"unnamed-{len(self.tables)}")] = self.table
        elif tag == "tr" and self.table is not None:
            self.table[1].append([])
        elif tag in ("th", "td"):
            self.cell = ""
        elif tag == "sup":
            self.skip += 1
        elif tag in ("p", "li", "code"):
            self.within = [tag, "", attributes]

    def handle_endtag(self, tag):
        if tag == "table":
            self.table[1][:] = [row for row in self.table[1] if row]
            self.table = None
        elif tag in ("th", "td") and self.cell is not None:
            text = self.cell.replace("\u00a0", " ").strip()
            (self.table[0] if tag == "th" else self.table[1][-1]).append(text)
            self.cell = None
        elif tag == "sup":
            self.skip -= 1
        elif self.within and tag == self.within[0]:
            if self.within[2].get("id") == "verdict":
                self.verdict = self.within[1]
            else:
                {"p": self.paragraphs, "li": self.items, "code": self.codes}[tag].append(self.within[1])
            self.within = None

    def handle_data(self, data):
        if self.skip:
            return
        if self.cell is not None:
            self.cell += data
        elif self.within:
            self.within[1] += data


def number(text):
    """The number that a cell shows and the value of half its last digit."""
    plain = text.replace("\u202f", "").replace("−", "-")
    return float(plain), 0.5 * 10.0 ** -(len(plain.split(".")[1]) if "." in plain else 0)


def agrees(shown, expected):
    if isinstance(expected, str):
        return shown == expected
    if expected is None or (isinstance(expected, float) and not math.isfinite(expected)):
        return shown == MISSING
    try:
        value, half = number(shown)
    except ValueError:
        return False
    return abs(value - expected) <= half * (1 + 1e-6) + 1e-12
