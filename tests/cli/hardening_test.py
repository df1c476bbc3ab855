# SPDX-License-Identifier: GPL-3.0-or-later
"""The program's file has what stops it where a fault would otherwise run on, and the bill of materials names what it is built from."""
import json
import os
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

PROGRAM = Path(os.environ["SWATH_PROGRAM"])
SOURCE = Path(os.environ["SWATH_SOURCE"])
BUILD = PROGRAM.parent.parent
SPDX_ID = re.compile(r"[A-Za-z0-9.+-]+")


def is_optimized():
    """By what CMake keeps of the build; true where it keeps nothing."""
    cache = BUILD / "CMakeCache.txt"
    return not cache.exists() or "CMAKE_BUILD_TYPE:STRING=Debug" not in cache.read_text()


def readelf(*options):
    return subprocess.run(["readelf", "--wide", *options, PROGRAM], capture_output=True, text=True, check=True).stdout


class Elf(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if "libasan" in readelf("-d"):
            sys.exit(77)  # the sanitizers take the place of the flags

    def expect(self, pattern, *options):
        self.assertTrue(re.search(pattern, readelf(*options)), f"readelf {' '.join(options)} shows nothing like {pattern}")

    def test_its_place_in_memory_is_random(self):
        self.expect(r"Type:\s+DYN", "-h")
        self.expect(r"FLAGS_1.*\bPIE\b", "-d")

    def test_what_the_loader_resolves_is_read_only_before_main(self):
        self.expect(r"GNU_RELRO", "-l")
        self.expect(r"\b(BIND_NOW|NOW)\b", "-d")

    def test_no_stack_is_executable(self):
        self.expect(r"GNU_STACK.*\sRW\s", "-l")

    def test_stacks_are_guarded(self):
        self.expect(r"\b__stack_chk_fail\b", "--dyn-syms")

    @unittest.skipUnless(is_optimized(), "_FORTIFY_SOURCE needs optimization")
    def test_buffers_are_guarded(self):
        self.expect(r"\b__(memcpy|snprintf|vsnprintf|read|pread64|fread)_chk\b", "--dyn-syms")


class Bill(unittest.TestCase):
    """Against the rules of CycloneDX 1.5 that matter to who reads it: required members, unique references, edges that lead somewhere."""

    @classmethod
    def setUpClass(cls):
        made = subprocess.run([sys.executable, "-B", SOURCE / "scripts/sbom.py", "--program", PROGRAM], capture_output=True, text=True)
        if made.returncode == 77:
            print(made.stderr)
            sys.exit(77)
        assert made.returncode == 0, made.stderr
        cls.bill = json.loads(made.stdout)
        cls.again = subprocess.run(made.args, capture_output=True, text=True, check=True).stdout == made.stdout

    def test_head(self):
        self.assertEqual(self.bill["bomFormat"], "CycloneDX")
        self.assertEqual(self.bill["specVersion"], "1.5")
        self.assertEqual(self.bill["version"], 1)
        self.assertRegex(self.bill["serialNumber"], r"^urn:uuid:[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}$")
        self.assertEqual(self.bill["metadata"]["component"]["name"], "swath")
        self.assertTrue(self.again, "the same program gives the same bill")

    def test_components(self):
        references = [c["bom-ref"] for c in self.bill["components"]]
        self.assertEqual(len(references), len(set(references)))
        for c in self.bill["components"]:
            self.assertIn(c["type"], ("library",))
            self.assertTrue(c["name"] and c["version"], c)
            self.assertRegex(c["purl"], r"^pkg:(cargo|deb|npm)/", c)
            for h in c.get("hashes", []):
                self.assertRegex(f"{h['alg']} {h['content']}", r"^(SHA-256 [0-9a-f]{64}|SHA-512 [0-9a-f]{128})$")
            for licence in c.get("licenses", []):
                self.assertEqual(len(licence), 1, licence)
                self.assertIn(next(iter(licence)), ("license", "expression"))
                if "id" in licence.get("license", {}):
                    self.assertRegex(licence["license"]["id"], SPDX_ID)
        known = {*references, self.bill["metadata"]["component"]["bom-ref"]}
        for edge in self.bill["dependencies"]:
            self.assertIn(edge["ref"], known)
            self.assertLessEqual(set(edge["dependsOn"]), known)

    def test_what_is_in_it(self):
        by_name = {c["name"]: c for c in self.bill["components"]}
        lock = (SOURCE / "io/laz/Cargo.lock").read_text()
        for name, version, checksum in re.findall(r'name = "(.+)"\nversion = "(.+)"\nsource = .+\nchecksum = "(.+)"', lock):
            self.assertEqual((by_name[name]["version"], by_name[name]["hashes"][0]["content"]), (version, checksum))
        if "built without its pages" not in subprocess.run([PROGRAM, "view", "/nowhere"], capture_output=True, text=True).stderr:
            self.assertLessEqual({"three", "laz-perf"}, by_name.keys())
            self.assertNotIn("esbuild", by_name)
        for package in ("libc6", "libgdal", "libproj", "libpng16"):
            self.assertTrue([n for n in by_name if n.startswith(package)], f"{package} is linked and not listed")
        if shutil.which("ninja") and (BUILD / ".ninja_deps").exists():  # else nothing says which headers were compiled
            for headers in ("libeigen3-dev", "libcli11-dev", "rapidjson-dev"):
                self.assertIn(headers, by_name, "headers are built in, too")
        self.assertTrue(all(c.get("licenses") for c in self.bill["components"] if c["purl"].startswith("pkg:cargo/")))


if __name__ == "__main__":
    unittest.main()
