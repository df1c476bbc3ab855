# SPDX-License-Identifier: GPL-3.0-or-later
"""Names that are local to a unit differ within a folder: with SWATH_UNITY a folder's units are compiled as one file (cmake/SwathRoom.cmake).

A build that compiles each unit alone (SWATH_UNITY=OFF) does not see such a clash. Found are constants, types and functions that two files of a folder
define in their unnamed namespaces, and constants and types that a header of the folder has, too; files with compile options of their own stay alone. Functions of one name may differ in their parameters, and two `using` of one name may say the same.
"""
import collections
import re
import sys
import unittest
from pathlib import Path

from sizes_test import ROOT, plain

ROOMS = ("core", "io", "filters", "terrain", "quality", "trajectory", "report", "planning", "georef", "calib", "simulate", "stages", "pipeline")

UNNAMED = re.compile(r"^namespace \{\n(.*?)^\}  // namespace$", re.S | re.M)
OWN_OPTIONS = re.compile(r"set_source_files_properties\(([^)]*?)PROPERTIES COMPILE_OPTIONS")
CONSTANT = re.compile(r"^(?:inline |static )*(?:constexpr|const|constinit|thread_local)\b(?=[^(]*?[={])([^;]*);", re.M)
NESTED = re.compile(r"<[^<>]*>|\([^()]*\)|\[[^\[\]]*\]|\{[^{}]*\}")
TYPE = re.compile(r"^(?:struct|class|enum class|enum|union)\s+(\w+)[^;{]*\{", re.M)
ALIAS = re.compile(r"^using\s+(\w+)\s*=\s*([^;]+);", re.M)
FUNCTION = re.compile(r"^(?!using|struct|class|enum|return|namespace)[A-Za-z_][\w:<>,&*\s]*?[\s&*](\w+)\(([^;{}]*?)\)\s*(?:const\s*)?(?:noexcept\s*)?\{", re.M)
LAST_NAME = re.compile(r"\s*\b\w+\s*(?=,|$)")


def parameters(text):
    """The types alone: no names of parameters, no defaults, no white space."""
    text = re.sub(r"=[^,]*", "", text)
    return re.sub(r"\s+", "", LAST_NAME.sub("", text))


def declared(text):
    """Names in "double a = 1.0, b = f(2, 3)"."""
    flat = ""
    while flat != text:
        flat, text = text, NESTED.sub("", text)
    return [re.findall(r"\w+", part.split("=")[0])[-1] for part in flat.split(",")]


def local_names(code):
    """(name, what tells two things of that name apart) of what the unnamed namespaces of `code` define."""
    for part in UNNAMED.finditer(code):
        body = plain(part[1])
        yield from ((name, "constant") for m in CONSTANT.finditer(body) for name in declared(m[1]))
        yield from ((m[1], "type") for m in TYPE.finditer(body))
        yield from ((m[1], "using " + re.sub(r"\s+", "", m[2])) for m in ALIAS.finditer(body))
        yield from ((m[1], f"({parameters(m[2])})") for m in FUNCTION.finditer(body))


def header_names(code):
    text = plain(code)
    yield from ((m[1], "type") for m in TYPE.finditer(text))
    yield from ((name, "constant") for m in CONSTANT.finditer(text) if m[0].startswith("inline") for name in declared(m[1]))


def clashes(files):
    """Sentences for the names that two of the files, path -> code, define."""
    seen = collections.defaultdict(dict)  # name -> kind -> file
    for path, code in files.items():
        for name, kind in header_names(code) if path.endswith(".h") else local_names(code):
            for other, where in seen[name].items():
                same_alias = kind == other and kind.startswith("using")
                overloads = kind != other and kind.startswith("(") and other.startswith("(")
                both_headers = where.endswith(".h") and path.endswith(".h")
                if where != path and not both_headers and not same_alias and not overloads:
                    yield f"{name}: {where} and {path}"
            seen[name].setdefault(kind, path)


class UnityNames(unittest.TestCase):
    def test_names_are_found(self):
        code = """namespace swath {
namespace {
constexpr double least = 3.0;  // of them
const std::array<int, 2> two = {1, 2}, more{3,
                                            4};
using Point = Eigen::Vector2d;
struct Way : Base {
  int a;
};
template <class T>
std::vector<T> read(const T& t, int n = 3) {
  const int inner = 1;
  return {};
}
}  // namespace
constexpr double outside = 1.0;
}  // namespace swath
"""
        self.assertEqual(sorted(local_names(code)), [("Point", "using Eigen::Vector2d"), ("Way", "type"), ("least", "constant"), ("more", "constant"), ("read", "(constT&,int)"), ("two", "constant")])

    def test_clashes_are_found(self):
        def unit(text):
            return "namespace {\n" + text + "\n}  // namespace\n"
        self.assertEqual(list(clashes({"a": unit("constexpr int n = 1;"), "b": unit("constexpr double n = 2;")})), ["n: a and b"])
        self.assertEqual(list(clashes({"a": unit("int f(int a) {\n}"), "b": unit("int f(int b) {\n}")})), ["f: a and b"])
        self.assertEqual(list(clashes({"a": unit("int f(int a) {\n}"), "b": unit("int f(double b) {\n}")})), [])
        self.assertEqual(list(clashes({"a": unit("using P = int;"), "b": unit("using P = int;")})), [])
        self.assertEqual(list(clashes({"a": unit("using P = int;"), "b": unit("using P = long;")})), ["P: a and b"])
        self.assertEqual(list(clashes({"a.h": "inline constexpr int n = 1;\n", "b": unit("constexpr double n = 2;")})), ["n: a.h and b"])
        self.assertEqual(list(clashes({"a.h": "struct Way {\n};\n", "b": unit("struct Way {\n};")})), ["Way: a.h and b"])

    def test_names_differ_within_a_folder(self):
        folders = collections.defaultdict(dict)
        for room in ROOMS:
            alone = " ".join(OWN_OPTIONS.findall((ROOT / room / "CMakeLists.txt").read_text(encoding="utf-8"))).split()
            for file in sorted(f for f in (ROOT / room).rglob("*") if f.suffix in (".h", ".cpp") and str(f.relative_to(ROOT / room)) not in alone):
                folders[file.parent][str(file.relative_to(ROOT))] = file.read_text(encoding="utf-8")
        names = sum(len(list(local_names(code))) for files in folders.values() for code in files.values())
        self.assertGreater(names, 1000)
        for folder, files in sorted(folders.items()):
            with self.subTest(str(folder.relative_to(ROOT))):
                self.assertEqual(list(clashes(files)), [])


if __name__ == "__main__":
    sys.exit(unittest.main())
