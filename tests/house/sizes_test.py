# SPDX-License-Identifier: GPL-3.0-or-later
"""Sizes of code outside tests: no file over 400 lines, and of all functions at most 0.3 % over 60 lines, counted from signature to brace.

Functions are found by their braces: a block that opens after a parameter list within namespaces, classes and modules alone. What lies inside it, lambdas
too, belongs to it.
"""
import re
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NOT_CODE = ("tests", "build")
FILE_LINES = 400
FUNCTION_LINES = 60
LONG_SHARE = 0.003

SKIPPED = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|r#".*?"#|"(?:[^"\\\n]|\\.)*"|(?<![\w])b?\'(?:[^\'\\\n]|\\[^\n]{1,8}?)\'|^ *#(?:[^\n]*\\\n)*[^\n]*', re.S | re.M)
CONTAINER = re.compile(r"(?:^|[;\s>])(?:namespace|class|struct|enum|union|extern|impl|trait|mod)\b(?![^;{]*\)\s*(?:const|noexcept|override|\s)*$)")


def plain(code):
    """Code without comments, strings, characters and directives; lines stay where they are."""
    return SKIPPED.sub(lambda m: "\n" * m[0].count("\n"), code)


def functions(code):
    """(name, first line, lines) of every function with a body."""
    text = plain(code)
    outer = True       # within containers alone
    blocks = []        # what each open brace is: "container", "function" or "other"
    start = 0          # of the statement
    parens = 0
    for i, c in enumerate(text):
        if not outer:
            if c == "{":
                blocks.append("other")
            elif c == "}":
                kind = blocks.pop()
                if kind == "function":
                    first = text.count("\n", 0, begin) + 1
                    yield name, first, text.count("\n", 0, i) + 2 - first
                outer = all(b == "container" for b in blocks)
                if outer:
                    start = start if kind == "other" else i + 1
            continue
        if c in "([":
            parens += 1
        elif c in ")]":
            parens -= 1
        elif c == ";" and not parens:
            start = i + 1
        elif c == "}" and blocks:
            blocks.pop()
            start = i + 1
        elif c == "{":
            head = text[start:i]
            called = re.search(r"([~\w:]+|operator\W+)\s*\(", head)
            if parens or not head[-1:].isspace() or head.rstrip().endswith("="):
                blocks.append("other")  # an initializer
            elif CONTAINER.search(head):
                blocks.append("container")
                start = i + 1
            elif called:
                blocks.append("function")
                name, begin = called[1], start + len(head) - len(head.lstrip())
            else:
                blocks.append("other")
            outer = blocks[-1] == "container"


def code_files():
    for file in sorted(ROOT.rglob("*")):
        if file.suffix in (".h", ".cpp", ".rs") and file.relative_to(ROOT).parts[0] not in NOT_CODE:
            yield file


class Sizes(unittest.TestCase):
    def test_functions_are_found(self):
        code = """namespace a {
struct S : B<int> {
  S() : a_{1}, b_("{") { f({}); }
  int g(int x = {}) const {  // }
    return [&] { return x; }();
  }
  std::vector<int> v{1, 2};
};
enum class E { one };
template <class T>
T h(
    T t) {
  if (t) {
    return '{';
  }
  return t;
}
const std::array<S, 2> table = {{S(1), S(2)}};
}  // namespace a
"""
        self.assertEqual([f for f in functions(code)], [("S", 3, 1), ("g", 4, 3), ("h", 10, 8)])
        rust = "mod m {\n  impl X {\n    fn a(&self) -> u8 {\n      b'{'\n    }\n  }\n}\nfn b() {}\n"
        self.assertEqual([f for f in functions(rust)], [("a", 3, 3), ("b", 8, 1)])

    def test_files_are_short(self):
        for file in code_files():
            lines = file.read_text(encoding="utf-8").count("\n")
            with self.subTest(str(file.relative_to(ROOT))):
                self.assertLessEqual(lines, FILE_LINES)

    def test_functions_are_short(self):
        found = [(lines, f"{file.relative_to(ROOT)}:{first}: {name}") for file in code_files()
                 for name, first, lines in functions(file.read_text(encoding="utf-8"))]
        long = sorted((f for f in found if f[0] > FUNCTION_LINES), reverse=True)
        self.assertGreater(len(found), 1000)
        self.assertLessEqual(len(long), LONG_SHARE * len(found), f"{len(long)} of {len(found)} functions have over {FUNCTION_LINES} lines:\n" +
                             "\n".join(f"{place}: {lines}" for lines, place in long))


if __name__ == "__main__":
    sys.exit(unittest.main())
