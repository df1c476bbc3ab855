# SPDX-License-Identifier: GPL-3.0-or-later
"""The bill of materials of a built program, CycloneDX 1.5 as JSON: crates and npm packages of the lock files, Debian packages of the libraries that it
loads and of the headers that it was compiled from.

  python3 scripts/sbom.py [--program build/release/tools/swath] [--output swath.cdx.json]

The same program on the same system gives the same bytes. Exit 77 where the system has no dpkg to ask.
"""
import argparse
import base64
import hashlib
import json
import re
import shutil
import subprocess
import sys
import tomllib
import uuid
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent
LOCK = SOURCE / "io/laz/Cargo.lock"
PAGES_LOCK = SOURCE / "web/package-lock.json"
ROOT = "swath"
# Debian's short names of licences, where SPDX has another.
SPDX = {"Expat": "MIT", "MIT/X11": "MIT", "Apache-2": "Apache-2.0", "BSD-2-clause": "BSD-2-Clause", "BSD-3-clause": "BSD-3-Clause",
        "GPL-2": "GPL-2.0-only", "GPL-2+": "GPL-2.0-or-later", "GPL-3": "GPL-3.0-only", "GPL-3+": "GPL-3.0-or-later",
        "LGPL-2": "LGPL-2.0-only", "LGPL-2+": "LGPL-2.0-or-later", "LGPL-2.1": "LGPL-2.1-only", "LGPL-2.1+": "LGPL-2.1-or-later",
        "LGPL-3": "LGPL-3.0-only", "LGPL-3+": "LGPL-3.0-or-later", "MPL-2": "MPL-2.0", "Apache-2.0": "Apache-2.0", "MIT": "MIT",
        "MPL-2.0": "MPL-2.0", "BSL-1.0": "BSL-1.0", "Zlib": "Zlib", "ISC": "ISC", "BSD-2-Clause": "BSD-2-Clause",
        "BSD-3-Clause": "BSD-3-Clause"}


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


# --- crates

def crates(build):
    """Components and edges of the lock file; licences from the crates as they were fetched for the build."""
    components, edges = [], {}
    packages = tomllib.loads(LOCK.read_text())["package"]
    reference = {p["name"]: f"pkg:cargo/{p['name']}@{p['version']}" for p in packages}
    if len(reference) < len(packages):
        sys.exit(f"{LOCK}: a crate is locked in two versions, and this script keeps one alone")
    for p in packages:
        wanted = sorted(reference[d.split()[0]] for d in p.get("dependencies", []))
        if "source" not in p:
            edges[ROOT] = wanted
            continue
        purl = reference[p["name"]]
        edges[purl] = wanted
        c = {"type": "library", "bom-ref": purl, "name": p["name"], "version": p["version"], "purl": purl,
             "hashes": [{"alg": "SHA-256", "content": p["checksum"]}]}
        manifest = build / "io/laz/crates" / p["name"] / "Cargo.toml"
        if manifest.exists():
            c["licenses"] = [{"expression": tomllib.loads(manifest.read_text())["package"]["license"]}]
        if p["name"] == "laz":
            c["pedigree"] = {"notes": "read_gps_time of point formats 6 to 10 is repaired in the build (io/laz/crates.cmake)"}
        components.append(c)
    return components, edges


# --- packages of the pages

def npm(build):
    """Those that the pages of swath view are bundled from, where the program has pages; esbuild, which bundles them, is not in them."""
    if not (build / "web/pages/pages.cpp").exists():
        return []
    components = []
    for path, p in json.loads(PAGES_LOCK.read_text())["packages"].items():
        if not path or p.get("dev"):
            continue
        name = path.removeprefix("node_modules/")
        algorithm, content = p["integrity"].split("-", 1)
        c = {"type": "library", "bom-ref": f"pkg:npm/{name}@{p['version']}", "name": name, "version": p["version"], "purl": f"pkg:npm/{name}@{p['version']}",
             "hashes": [{"alg": algorithm.upper().replace("SHA", "SHA-"), "content": base64.b64decode(content).hex()}]}
        if "license" in p:
            c["licenses"] = [{"expression": p["license"]}]
        components.append(c)
    return components


# --- Debian packages

def owners():
    """File -> package, for every file of every package. Libraries that are listed under /lib lie in /usr/lib on today's systems."""
    out = {}
    for listing in Path("/var/lib/dpkg/info").glob("*.list"):
        for name in listing.read_text(errors="replace").splitlines():
            if "/include/" in name or "/lib" in name:
                out["/usr" + name if name.startswith("/lib") else name] = listing.stem.split(":")[0]
    return out


def file_of(path):
    real = str(Path(path).resolve())
    return "/usr" + real if real.startswith("/lib") else real


def delayed(program):
    """Names of the libraries that the program loads at their first use, by its notes (cmake/delayed_stubs.cmake)."""
    return re.findall(r'"soname":\["([^"]+)"\]', run("readelf", "-p", ".note.dlopen", program))


def loaded(program, owner):
    """Packages of the libraries that the loader finds for the program -> packages that each needs itself."""
    found, late = {}, delayed(program)
    known = dict(re.findall(r"\s(\S+) \(.*x86-64.*\) => (/\S+)", run(shutil.which("ldconfig") or "/sbin/ldconfig", "-p"))) if late else {}
    found.update((name, known[name]) for name in late if name in known)
    for path in [program, *list(found.values())]:
        for line in run("ldd", path).splitlines():
            match = re.match(r"\s*(\S+) => (/\S+)", line) or re.match(r"\s*(/\S+)()", line)
            if match:
                found.setdefault(Path(match[1]).name, match[2] or match[1])
    package = {name: owner.get(file_of(path)) for name, path in found.items()}
    needs = {}
    for name, path in [(ROOT, program), *found.items()]:
        mine = ROOT if name == ROOT else package[name]
        if mine:
            wanted = re.findall(r"\(NEEDED\).*\[(.+)\]", run("readelf", "-d", path)) + (late if name == ROOT else [])
            needs.setdefault(mine, set()).update(package[w] for w in wanted if package.get(w) not in (None, mine))
    return needs


def compiled_from(build, owner):
    """Packages of the headers that the program's objects were made of, as ninja keeps them."""
    if not shutil.which("ninja") or not (build / ".ninja_deps").exists():
        print("no list of headers: the program was not built by ninja here", file=sys.stderr)
        return set()
    headers, ours = set(), False
    for line in run("ninja", "-C", str(build), "-t", "deps").splitlines():
        if not line.startswith(" "):
            ours = not line.startswith(("tests/", "bench/"))
        elif ours and "/usr/" in line:
            headers.add(line.strip())
    return {owner[h] for h in map(file_of, headers) if h in owner}


def licence_of(package):
    """What the package's copyright file says of all its files, where it says so in Debian's form."""
    path = Path("/usr/share/doc") / package / "copyright"
    if not path.exists():
        return []
    text = path.read_text(errors="replace")
    match = re.search(r"^Files:[ \t]*\*[ \t]*\n(?:(?!\n\n)(?:.|\n))*?^License:[ \t]*(\S.*)$", text, re.MULTILINE)
    if not match:
        return [{"license": {"name": f"see /usr/share/doc/{package}/copyright"}}]
    name = match[1].strip()
    return [{"license": {"id": SPDX[name]} if name in SPDX else {"name": name}}]


def debian(packages):
    form = "${Package}\\t${Version}\\t${Architecture}\\n"
    reference, components = {}, []
    system = re.search(r'^ID="?([^"\n]+)', Path("/etc/os-release").read_text(), re.MULTILINE)[1]
    for line in sorted(set(run("dpkg-query", "-W", "-f", form, *sorted(packages)).splitlines())):
        name, version, architecture = line.split("\t")
        if name in reference:
            continue  # installed for two architectures
        reference[name] = f"pkg:deb/{system}/{name}@{version.replace('+', '%2B').replace(':', '%3A')}?arch={architecture}"
        c = {"type": "library", "bom-ref": reference[name], "name": name, "version": version, "purl": reference[name]}
        if licences := licence_of(name):
            c["licenses"] = licences
        components.append(c)
    return components, reference


def bill(program):
    build = program.parent.parent
    owner = owners()
    needs = loaded(str(program), owner)
    headers = compiled_from(build, owner)
    libraries, reference = debian(({p for p in needs if p != ROOT} | set().union(*needs.values()) | headers))
    components, edges = crates(build)
    pages = npm(build)
    components += pages
    edges[ROOT] = [*edges[ROOT], *(c["bom-ref"] for c in pages)]
    for package, wanted in needs.items():
        mine = ROOT if package == ROOT else reference[package]
        edges[mine] = sorted({*edges.get(mine, []), *(reference[w] for w in wanted)})
    edges[ROOT] = sorted({*edges[ROOT], *(reference[h] for h in headers)})
    version = re.search(r"project\(swath VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text())[1]
    content = hashlib.sha256(program.read_bytes()).hexdigest()
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_OID, content)}",
        "version": 1,
        "metadata": {"component": {"type": "application", "bom-ref": ROOT, "name": "swath", "version": version,
                                   "licenses": [{"license": {"id": "GPL-3.0-or-later"}}],
                                   "hashes": [{"alg": "SHA-256", "content": content}]}},
        "components": sorted([*components, *libraries], key=lambda c: c["bom-ref"]),
        "dependencies": [{"ref": ref, "dependsOn": wanted} for ref, wanted in sorted(edges.items())],
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=SOURCE / "build/release/tools/swath")
    parser.add_argument("--output", type=Path)
    arguments = parser.parse_args()
    if not shutil.which("dpkg-query"):
        print("no dpkg on this system: the packages of the linked libraries are not known", file=sys.stderr)
        return 77
    text = json.dumps(bill(arguments.program.resolve()), indent=2) + "\n"
    if arguments.output:
        arguments.output.write_text(text)
    else:
        sys.stdout.write(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
