# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain English: words that no text for readers may hold, the length of option texts, and files that docs name.

Refused are WORDS in docs, configs, option texts, help and comments. Messages and keys of reports hold some of them still: these are
counted in MESSAGES, a number that may only fall; they go when results are declared once, because tests and readers of report.json know them.
"""
import re
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = "core io filters terrain quality trajectory report georef calib planning simulate stages pipeline tools python".split()
# Pattern -> what to write instead.
WORDS = {
    r"tells?|telling|told": "reports, shows, says; distinguish, determine; known",
    r"mend(?:s|ed|ing)?": "repaired, fixed, corrected",
    r"bearable": "tolerance, acceptable",
    r"errs?|erred|erring": "is off by, has an error of",
    r"dear|dearer": "expensive, costly",
    r"hangs? together|hanging together": "is correlated with, is connected",
    r"said water": "classified as water",
    r"the way on": "next step, path",
}
DOCS_ONLY = {
    r"tally|tallies": "count",  # but for the name of the type in docs/add-a-stage.md
    r"doors?": "readers and writers",
    r"rooms?": "folders, modules",
    r"lines across": "cross lines",
}
OPTION_NAMES = r"(?:most|least)_\w+"
# Option names of the form that the word list refuses; they are renamed with the declaration of results.
KNOWN_OPTIONS = 1
# Strings of code outside option texts that hold WORDS: messages, warnings, keys and names of counts.
MESSAGES = 32
OPTION_LENGTH = 100
# Texts of options and tables that are longer: lists of values that need their numbers. May only fall.
LONG_OPTIONS = 15
# Pages that quote messages or keys as the program writes them.
QUOTED = re.compile(r"`[^`\n]*`")

STRING = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
COMMENT = re.compile(r'^((?:[^"/\n]|"(?:[^"\\\n]|\\.)*"|/(?!/))*)//(.*)$', re.M)


def pattern(words):
    return re.compile(r"\b(?:" + "|".join(words) + r")\b", re.I)


def hits(words, text):
    return [(m[0], next(better for w, better in words.items() if re.fullmatch(w, m[0], re.I))) for m in pattern(words).finditer(text)]


def code_files():
    for room in ROOMS:
        yield from (f for f in sorted((ROOT / room).rglob("*")) if f.suffix in (".h", ".cpp"))


def comments(code):
    return "\n".join(re.sub(r'`[^`]*`|"[^"]*"', "", m[2]) for m in COMMENT.finditer(code))


DESCRIBED = re.compile(r"\bv\.(?:option|tables?)\((.*?)\);\n", re.S)


def option_calls(code):
    """(name, [texts]) of every v.option(...), v.table(...) and v.tables(...)."""
    for call in DESCRIBED.findall(code):
        strings = [s for s in STRING.findall(re.sub(r'"\s*\n?\s*"', "", call))]
        if strings:
            yield strings[0], strings[1:]


def pages():
    yield from (f for f in [ROOT / "README.md", ROOT / "SECURITY.md", *sorted((ROOT / "docs").rglob("*.md")), *sorted((ROOT / "configs").glob("*.toml"))]
                if f.name != "bibliography.md")


def name(file):
    return str(file.relative_to(ROOT))


class Words(unittest.TestCase):
    def test_the_patterns_find_faults(self):
        self.assertEqual(len(hits(WORDS, "The report tells it. Mended. They hang together; a reference errs.")), 4)
        self.assertEqual(hits(WORDS, "a hotel, foretold, amend, terrain, errors, deary"), [])
        self.assertEqual(comments('int a;  // it tells "told"\nf("// told");\n').strip(), "it tells")
        self.assertEqual(list(option_calls('v.option("a", o.a, "One "\n  "two.", "B2000");\nv.table("t", o.t, "A table.");\nv.tables("u", o.u,\n"Tables.");\n')),
                         [("a", ["One two.", "B2000"]), ("t", ["A table."]), ("u", ["Tables."])])

    def test_docs_and_configs(self):
        for file in pages():
            text = file.read_text(encoding="utf-8")
            text = re.sub(r"^ *```\w+\n.*?^ *```", lambda m: "\n" * m[0].count("\n"), text, flags=re.M | re.S)  # code keeps its names
            for number, line in enumerate(text.splitlines(), 1):
                for word, better in hits({**WORDS, **DOCS_ONLY}, QUOTED.sub("", line)):
                    with self.subTest(f"{name(file)}:{number}"):
                        self.fail(f"{name(file)}:{number}: '{word}'; better: {better}")

    def test_comments(self):
        for file in code_files():
            for word, better in hits(WORDS, comments(file.read_text(encoding="utf-8"))):
                with self.subTest(name(file)):
                    self.fail(f"{name(file)}: '{word}' in a comment; better: {better}")

    def test_option_texts(self):
        for file in code_files():
            for option, texts in option_calls(file.read_text(encoding="utf-8")):
                for word, better in hits({**WORDS, **DOCS_ONLY}, " ".join(texts)):
                    with self.subTest(f"{name(file)}: {option}"):
                        self.fail(f"{name(file)}: option '{option}': '{word}'; better: {better}")

    def test_options_fit_their_line(self):
        long = [f"{name(f)}: {option}: {len(t)}" for f in code_files() for option, texts in option_calls(f.read_text(encoding="utf-8"))
                for t in texts if len(t) > OPTION_LENGTH]
        self.assertLessEqual(len(long), LONG_OPTIONS, "\n".join(["option texts over 100 characters:", *long]))

    def test_names_of_options_do_not_grow(self):
        found = [f"{name(f)}: {option}" for f in code_files() for option, _ in option_calls(f.read_text(encoding="utf-8")) if re.fullmatch(OPTION_NAMES, option)]
        self.assertLessEqual(len(found), KNOWN_OPTIONS, "max_ and min_ in place of most_ and least_:\n" + "\n".join(found))

    def test_messages_do_not_grow(self):
        found = []
        for file in code_files():
            code = COMMENT.sub(lambda m: m[1], file.read_text(encoding="utf-8"))
            code = DESCRIBED.sub("", code)
            found += [f"{name(file)}: {s}" for s in STRING.findall(code) if hits(WORDS, s)]
        self.assertLessEqual(len(found), MESSAGES, "words of the list in messages:\n" + "\n".join(found))


class Pages(unittest.TestCase):
    def test_files_that_pages_name_are_there(self):
        folders = "|".join([*ROOMS, "tests", "bench", "configs", "cmake", "scripts", "docs"])
        for page in (f for f in pages() if f.suffix == ".md" and f.name != "add-a-stage.md"):  # that one names files that one would make
            for path in re.findall(rf"`((?:{folders})/[\w./-]*\w\.(?:cpp|h|py|sh|toml|md))`", page.read_text(encoding="utf-8")):
                with self.subTest(name(page)):
                    self.assertTrue((ROOT / path).exists(), f"{name(page)} names {path}, which is not there")

    def test_links_lead_to_pages(self):
        for page in (f for f in pages() if f.suffix == ".md"):
            text = re.sub(r"^(?: {4}|```).*$", "", page.read_text(encoding="utf-8"), flags=re.M)
            for target in re.findall(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)", text):
                with self.subTest(name(page)):
                    self.assertTrue((page.parent / target).exists(), f"{name(page)} links to {target}, which is not there")


if __name__ == "__main__":
    sys.exit(unittest.main())
