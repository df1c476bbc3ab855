# SPDX-License-Identifier: GPL-3.0-or-later
"""Every citation of code and docs has an entry in docs/bibliography.md, and every entry is cited.

Found are: sources of options ("Pingel2013, stage 2"), and authors with a year in comments and docs ("Pingel, Clarke & McBride 2013", "Julier and Uhlmann,
"title", ACC 1997", "Glira2016"). The key of a paper is its first author, without accents, and the year. One name alone with a year ("Sea 1956") counts
where it is that of an author in the bibliography.
"""
import re
import sys
import unicodedata
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = "core io filters terrain quality trajectory report georef calib planning simulate stages pipeline tools".split()
NAME = r"(?:Mc|Le)?[A-Z][a-zäöüéß]+(?:-[A-Z][a-zäöü]+)?"
YEAR = r"(?:19|20)[0-9]{2}(?!\.?[0-9]|[%-]| m\b)"
AUTHORS = rf"\b(?P<first>{NAME})(?P<others>(?:(?:,? and |,? & |, )(?:de )?{NAME})*(?: et al\.)?)"
DIRECT = re.compile(AUTHORS + rf",? \(?(?P<year>{YEAR})")
TITLED = re.compile(AUTHORS + rf",\s*\"[^\"]+\"[^\";]{{0,70}}?[( ](?P<year>{YEAR})")
JOINED = re.compile(rf"\b(?P<first>{NAME})(?P<others>)(?P<year>(?:19|20)[0-9]{{2}})\b")
LISTED = re.compile(r"^\| `([^`]+)` \|", re.M)
BIBLIOGRAPHY = (ROOT / "docs/bibliography.md").read_text(encoding="utf-8")
MONTHS = "January February March April May June July August September October November December".split()


def plain(text):
    return "".join(c for c in unicodedata.normalize("NFKD", text) if not unicodedata.combining(c))


def authors(pages):
    """Names of all authors of a bibliography: those of its keys, and before an initial in the part of an entry that ends with a colon."""
    names = {re.match(r"[^\d]+", key)[0] for key in LISTED.findall(pages)}
    for entry in re.findall(r"^\| `[^`]+` \| ([^:]+):", pages, re.M):
        names |= {plain(name) for name in re.findall(rf"({NAME}), [A-Z]", entry)}
    return names


PLACEHOLDER = "Author"  # in the example of docs/add-a-stage.md
KNOWN = authors(BIBLIOGRAPHY)


def cited_in(text):
    """Keys of authors with a year in running text."""
    found = set()
    for pattern in (DIRECT, TITLED, JOINED):
        for m in pattern.finditer(text):
            first = plain(m["first"])
            if first in KNOWN or pattern is not DIRECT and first != PLACEHOLDER or m["others"] and first not in MONTHS:
                found.add(first + m["year"])
    return found


def comments(code):
    """Blocks of comment lines as running text."""
    for block in re.findall(r"(?:^[^\n]*?//[^\n]*\n)+", code, re.M):
        yield " ".join(line.split("//", 1)[1].lstrip("/<! ").strip() for line in block.splitlines())


def sources(code):
    """Last strings of the calls of v.option that have a text and a source."""
    for call in re.findall(r"v\.option\((.*?)\);\n", code, re.S):
        call = re.sub(r'"\s*\n\s*"', "", call)
        texts = re.findall(r'"((?:[^"\\]|\\.)*)"\s*$', call)
        if texts and len(re.findall(r'"(?:[^"\\]|\\.)*"', call)) > 2 and not texts[0].endswith("."):
            yield texts[0]


def key_of(source):
    """Key of an option's source: its first word, or its first two where those are author and year."""
    return plain(re.match(r"[\w-]+", source)[0]) if source else ""


def code_files():
    for room in ROOMS:
        yield from (f for f in sorted((ROOT / room).rglob("*")) if f.suffix in (".h", ".cpp", ".rs"))


def citations():
    """{key: [file, ...]}"""
    found = {}
    for file in code_files():
        code = file.read_text(encoding="utf-8")
        keys = {key_of(s) for s in sources(code)}
        for text in comments(code):
            keys |= cited_in(text)
        for text in re.findall(r'"(?:[^"\\\n]|\\.)*"', code):
            keys |= cited_in(text)
        for key in keys:
            found.setdefault(key, []).append(str(file.relative_to(ROOT)))
    for file in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        if file.name != "bibliography.md":
            for key in cited_in(file.read_text(encoding="utf-8")):
                found.setdefault(key, []).append(str(file.relative_to(ROOT)))
    return found


class Citations(unittest.TestCase):
    entries = LISTED.findall(BIBLIOGRAPHY)

    def test_the_patterns_find_what_code_writes(self):
        for text, key in (("Pingel, Clarke & McBride 2013, \"An improved\"", "Pingel2013"), ("(Höfle, Vetter, Pfeifer & Stötter 2009", "Hofle2009"),
                          ('Julier and Uhlmann, "A non-divergent estimation", ACC 1997.', "Julier1997"), ("Bar-Shalom, Li 2001", "Bar-Shalom2001"),
                          ("Reis, Camargo, Tommaselli (2011)", "Reis2011"), ("de Jong and Mackinnon 1988", "Jong1988"), ("Glira et al. (2016)", "Glira2016"),
                          ("by Glira 2099", "Glira2099"), ("as Mandlburger (2099) has it", "Mandlburger2099"), ("source: Nobody2099 eq 3", "Nobody2099"),
                          ("Nobody et al. 2099", "Nobody2099"), ("Nobody, \"A title\", ACC 2099", "Nobody2099")):
            self.assertEqual(cited_in(text), {key}, text)
        self.assertEqual(cited_in("Measured 2026-11-22; level of the Baltic Sea 1956; Windows 2000, Debian 2024; May and June 2024; DHHN2016"), set())
        self.assertEqual(authors("| `Hofle2009` | Höfle, B., de Boor, C., Longuet-Higgins, M. S.: Water, E. |\n"), {"Hofle", "Boor", "Longuet-Higgins"})
        code = 'v.option("a", o.a, "First.");\nv.option("b", o.b, core::above(0.0), "Second "\n  "text.",\n "Zhang2003 eq 4");\n'
        self.assertEqual(list(sources(code)), ["Zhang2003 eq 4"])

    def test_every_citation_has_an_entry(self):
        for key, files in sorted(citations().items()):
            self.assertTrue(key in self.entries, f"{', '.join(files[:3])}: no entry `{key}` in docs/bibliography.md")

    def test_every_entry_is_cited_and_in_order(self):
        everything = " ".join(f.read_text(encoding="utf-8") for f in code_files())
        found = citations()
        for key in self.entries:
            self.assertTrue(key in found or not re.search(r"\d", key) and re.search(rf"\b{key}\b", everything), f"nothing cites `{key}`")
        papers = [k for k in self.entries if re.search(r"\d{4}$", k)]
        self.assertEqual(papers, sorted(papers))
        self.assertEqual(len(self.entries), len(set(self.entries)))


if __name__ == "__main__":
    sys.exit(unittest.main())
