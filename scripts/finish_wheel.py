# SPDX-License-Identifier: GPL-3.0-or-later
"""Completes a wheel that auditwheel has repaired: finish_wheel.py WHEEL FOLDER; needs `wheel` and patchelf.

- Libraries that manylinux takes for granted and a system without a desktop lacks (libX11, libexpat) come in, with what they need.
- The licences of all libraries in it, from the Debian packages that they come from: swath/share/doc/licences.

The wheel is written to FOLDER. Its files are dated by SOURCE_DATE_EPOCH.
"""
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

# Of the C library, and what the interpreter and every compiler bring with them.
OF_THE_SYSTEM = re.compile(r"(ld-linux.*|lib(c|m|dl|rt|pthread|resolv|util|nsl|anl|mvec|gcc_s|stdc\+\+|z))\.so.*")


def said(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def needed(file):
    """Names of the libraries that a library or program is linked with; none for other files."""
    return said("patchelf", "--print-needed", str(file)).split()


def is_elf(file):
    with open(file, "rb") as f:
        return f.read(4) == b"\x7fELF"


def plain_name(file):
    """The name of a library before auditwheel put a checksum into it: libproj-222f463f.so.25.9.1.1."""
    return re.sub(r"-[0-9a-f]{8}(?=\.)", "", file.name)


def system_libraries():
    """The files of the system's libraries by their names."""
    out = {}
    for line in said("/sbin/ldconfig", "-p").splitlines():
        if (found := re.match(r"\s*(\S+) \(libc6,x86-64[^)]*\) => (\S+)", line)) or (found := re.match(r"\s*(\S+) \(.*\) => (\S+)", line)):
            out.setdefault(found[1], Path(found[2]))
    return out


def add_missing(root, libraries):
    """Copies what no file of the wheel and no bare system has into the folder of libraries."""
    system = system_libraries()
    added = []
    queue = [f for f in sorted(root.rglob("*")) if f.is_file() and is_elf(f)]
    while queue:
        file = queue.pop(0)
        for name in needed(file):
            if OF_THE_SYSTEM.fullmatch(name) or (libraries / name).exists():
                continue
            grafted = next((g for g in sorted(libraries.iterdir()) if plain_name(g) != g.name and plain_name(g).startswith(name)), None)
            if grafted:
                subprocess.run(["patchelf", "--replace-needed", name, grafted.name, str(file)], check=True)
                continue
            if name not in system:
                sys.exit(f"swath: {file.name} needs {name}, which is not on this system")
            new = libraries / name
            shutil.copy2(system[name].resolve(), new)
            new.chmod(0o755)
            subprocess.run(["patchelf", "--force-rpath", "--set-rpath", "$ORIGIN", str(new)], check=True)
            added.append(name)
            queue.append(new)
    return added


def add_licences(folder, libraries):
    """Returns the names of the packages, and of the libraries that belong to none."""
    packages, without = set(), []
    for file in sorted(libraries.iterdir()):
        found = subprocess.run(["dpkg-query", "-S", f"*/{plain_name(file)}"], capture_output=True, text=True).stdout
        owners = {line.split(":")[0] for line in found.splitlines() if not line.startswith("diversion")}
        packages |= owners
        if not owners:
            without.append(file.name)
    folder.mkdir(parents=True)
    for package in sorted(packages):
        if (text := Path("/usr/share/doc") / package / "copyright").is_file():
            shutil.copyfile(text, folder / package)
            (folder / package).chmod(0o644)
    return packages, without


def pack(root, to):
    """Writes the wheel to a folder, with the strongest compression that every zip reader reads."""
    with tempfile.TemporaryDirectory() as name:
        said(sys.executable, "-m", "wheel", "pack", "-d", name, str(root))
        quick = next(Path(name).iterdir())
        with zipfile.ZipFile(quick) as source, zipfile.ZipFile(to / quick.name, "w") as smallest:
            for entry in source.infolist():
                smallest.writestr(entry, source.read(entry), zipfile.ZIP_DEFLATED, compresslevel=9)


def main():
    wheel, to = map(Path, sys.argv[1:])
    to.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        said(sys.executable, "-m", "wheel", "unpack", "-d", name, str(wheel))
        root = next(Path(name).iterdir())
        libraries = root / "swath.libs"
        added = add_missing(root, libraries)
        packages, without = add_licences(root / "swath/share/doc/licences", libraries)
        pack(root, to)
        size = sum(f.stat().st_size for f in root.rglob("*") if f.is_file())
        print(f"unpacked: {size / 1e6:.0f} MB, {len(list(libraries.iterdir()))} libraries of {len(packages)} packages; added: {' '.join(added) or 'none'}")
        if without:
            print("without a licence, for no package has them: " + " ".join(without))


if __name__ == "__main__":
    main()
