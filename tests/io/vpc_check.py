# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds a virtual point cloud of ours against the STAC schemas, by pystac: vpc_check.py LAS_SAMPLES FOLDER"""
import json
import pathlib
import shutil
import subprocess
import sys

try:
    import pystac
    from pystac.validation import validate_dict
except ImportError as missing:
    print(f"SKIPPED: {missing}; the environment could not be made")
    sys.exit(77)

samples, folder = sys.argv[1], pathlib.Path(sys.argv[2])
shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
subprocess.run([samples, "vpc", str(folder)], check=True)
tree = json.loads((folder / "a.vpc").read_text())
assert pystac.ItemCollection.is_item_collection(tree)
items = pystac.ItemCollection.from_dict(tree)
assert len(items) == 2, len(items)
extensions = 0
for item in items:
    core = dict(item.to_dict(include_self_link=False), stac_extensions=[])
    validate_dict(core)  # the schemas of the core come with pystac
    try:
        extensions += len(item.validate())
    except pystac.STACValidationError:
        raise
    except Exception as fault:  # schemas of extensions are fetched
        print(f"extensions are not looked at: {fault}")
    assert (folder / item.assets["data"].href).exists()
    assert item.properties["pc:count"] == 1000 and item.bbox[0] < item.bbox[2] and item.bbox[1] < item.bbox[3]
shutil.rmtree(folder)
print(f"pystac {pystac.__version__}: {len(items)} items are valid, {extensions} schemas in all")
