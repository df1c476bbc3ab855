# SPDX-License-Identifier: GPL-3.0-or-later
"""Clouds and rasters in an object store: the S3 server of `moto` on this machine, by GDAL's own settings."""
import json
import logging
import os
import shutil
import sys
import time
import unittest

try:
    import boto3
    from moto.server import ThreadedMotoServer
except ImportError as fault:
    print(f"SKIPPED: the Python package moto is not there ({fault}); see tests/cli/stores_requirements.txt")
    sys.exit(77)

from counting_proxy import CountingProxy
from support import SMALL, SOURCE, Case, products, swath

CLOUD = SOURCE / "configs" / "cloud.toml"
LONGEST = 60  # s: of any refusal
SETTINGS = ("AWS_S3_ENDPOINT", "AWS_HTTPS", "AWS_VIRTUAL_HOSTING", "AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY", "AWS_NO_SIGN_REQUEST",
            "AWS_CONFIG_FILE", "AWS_SHARED_CREDENTIALS_FILE", "AWS_DEFAULT_REGION")
POINTS = """
[run]
tile = "10 km"
[[stage]]
type = "readers.trajectory"
[[stage]]
type = "readers.laser"
[[stage]]
type = "georeference"
[[stage]]
type = "writers.las"
"""
COPC = '[[stage]]\ntype = "readers.las"\n[[stage]]\ntype = "writers.copc"\n'
PLAIN = '[run]\ntile = "10 km"\n[[stage]]\ntype = "readers.las"\n[[stage]]\ntype = "writers.las"\ncompress = false\n'


class StoreCase(Case):
    """One bucket with a cloud as LAS, LAZ and COPC, its terrain model, and the same files in `cls.files`."""
    simulated = [*SMALL, "scanner.prf=60 kHz"]

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        logging.getLogger("werkzeug").setLevel(logging.ERROR)
        cls.server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
        cls.server.start()
        port = cls.server.get_host_and_port()[1]
        cls.proxy = CountingProxy(port)
        cls.before = {key: os.environ.pop(key, None) for key in SETTINGS}
        os.environ.update({"AWS_S3_ENDPOINT": f"127.0.0.1:{cls.proxy.port}", "AWS_HTTPS": "NO", "AWS_VIRTUAL_HOSTING": "FALSE",
                           "AWS_ACCESS_KEY_ID": "test", "AWS_SECRET_ACCESS_KEY": "secret", "AWS_CONFIG_FILE": "/nowhere",
                           "AWS_SHARED_CREDENTIALS_FILE": "/nowhere"})
        cls.client = boto3.client("s3", endpoint_url=f"http://127.0.0.1:{port}", region_name="us-east-1")
        cls.client.create_bucket(Bucket="surveys")
        cls.files = cls.class_folder / "files"
        cls.files.mkdir()
        cls.make_files()
        for file in cls.files.iterdir():
            cls.put(file, file.name)

    @classmethod
    def tearDownClass(cls):
        cls.proxy.close()
        cls.server.stop()
        for key, value in cls.before.items():
            os.environ.pop(key, None)
            if value is not None:
                os.environ[key] = value
        super().tearDownClass()

    @classmethod
    def put(cls, file, key):
        cls.client.upload_file(str(file), "surveys", key)

    @classmethod
    def make(cls, name, config, survey, product):
        made = cls.class_folder / f"made_{name}"
        (cls.class_folder / "config.toml").write_text(config)
        done = swath("run", cls.class_folder / "config.toml", "--survey", survey, "--output", made, "--quiet")
        assert done.returncode == 0, done.stderr
        found = sorted(made.glob(product))
        shutil.copy(found[0], cls.files / name)
        return cls.files / name

    @classmethod
    def make_files(cls):
        laz = cls.make("a.laz", POINTS, cls.survey / "survey.toml", "points/*.laz")
        cloud = cls.cloud(laz, cls.class_folder)
        cls.make("a.copc.laz", COPC, cloud, "*.copc.laz")
        cls.make("a.las", PLAIN, cloud, "points/*.las")
        cls.make("dtm.tif", CLOUD.read_text(), cloud, "dtm/*[0-9].tif")

    @staticmethod
    def cloud(file, folder, more=""):
        folder.mkdir(exist_ok=True)
        (folder / "cloud.toml").write_text(f'name = "cloud"\n{more}[[points]]\nfile = "{file}"\n')
        return folder / "cloud.toml"

    def run_cloud(self, file, name, *more, config=CLOUD, survey=""):
        out = self.folder / name
        cloud = self.cloud(file, self.folder / f"{name}_survey", survey)
        done = swath("run", config, "--survey", cloud, "--output", out, "--quiet", *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return out

    def refused(self, *arguments, says, where, code=1, **environment):
        start = time.monotonic()
        done = swath(*arguments, env={k: v for k, v in {**os.environ, **environment}.items() if v is not None})
        self.assertLess(time.monotonic() - start, LONGEST)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertEqual(done.stderr.count("swath: error:"), 1, done.stderr)
        for part in (says, where, *(["hint:"] if code == 1 else [])):
            self.assertIn(part, done.stderr)


class Stores(StoreCase):
    def test_products_are_those_of_the_local_file(self):
        for name in ("a.las", "a.laz", "a.copc.laz"):
            local = products(self.run_cloud(self.files / name, f"local_{name}"))
            out = self.run_cloud(f"s3://surveys/{name}", f"stored_{name}")
            self.assertEqual(local, products(out), name)
            inputs = json.loads((out / "report.json").read_text())["inputs"]
            self.assertEqual([i["file"] for i in inputs], [f"s3://surveys/{name}"])
            self.assertEqual(inputs[0]["bytes"], (self.files / name).stat().st_size)

    def test_a_job_takes_an_address(self):
        for name, file in (("local", self.files / "a.laz"), ("stored", "/vsis3/surveys/a.laz")):
            done = swath("dtm", file, "--output", self.folder / name, "--quiet")
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(products(self.folder / "local"), products(self.folder / "stored"))

    def test_a_box_of_a_copc_fetches_its_nodes_alone(self):
        config = self.folder / "box.toml"
        facts = json.loads(swath("info", self.files / "a.copc.laz", "--json").stdout)
        (west, east), (south, north) = facts["x"], facts["y"]
        box = [west + 0.6 * (east - west), south + 0.6 * (north - south), west + 0.7 * (east - west), south + 0.7 * (north - south)]
        config.write_text(f'[[stage]]\ntype = "readers.las"\nbounds = {box}\n[[stage]]\ntype = "writers.las"\n')
        local = products(self.run_cloud(self.files / "a.copc.laz", "local", config=config))
        self.proxy.reset()
        self.assertEqual(local, products(self.run_cloud("s3://surveys/a.copc.laz", "stored", config=config)))
        self.assertLess(self.proxy.bytes, 0.6 * (self.files / "a.copc.laz").stat().st_size)

    def test_info_reads_a_small_part(self):
        for name in ("a.copc.laz", "a.laz", "a.las"):
            size = (self.files / name).stat().st_size
            self.proxy.reset()
            done = swath("info", f"s3://surveys/{name}", "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertGreater(size, 1_000_000)
            self.assertLess(self.proxy.bytes, 0.1 * size, name)
            stored, local = json.loads(done.stdout), json.loads(swath("info", self.files / name, "--json").stdout)
            for key in ("bytes", "format", "version", "points", "x", "y", "z", "returns", "crs"):
                self.assertEqual(stored[key], local[key], key)
            self.assertEqual(stored.get("copc"), local.get("copc"))

    def test_info_of_a_raster(self):
        stored = json.loads(swath("info", "s3://surveys/dtm.tif", "--json").stdout)
        local = json.loads(swath("info", self.files / "dtm.tif", "--json").stdout)
        self.assertEqual({**stored, "file": ""}, {**local, "file": ""})

    def test_a_reference_raster(self):
        config = self.folder / "config.toml"
        for name, file in (("local", self.files / "dtm.tif"), ("stored", "s3://surveys/dtm.tif")):
            config.write_text(CLOUD.read_text().split("[[stage]]\ntype = \"filters.hag_dem\"")[0] +
                              f'[[stage]]\ntype = "quality.surface"\nreference = "{file}"\n')
            self.run_cloud(self.files / "a.laz", name, config=config)
        found = [json.loads((self.folder / name / "surface.json").read_text()) for name in ("local", "stored")]
        self.assertEqual(found[0]["rms_m"], found[1]["rms_m"])

    def test_a_web_server(self):
        self.client.put_object_acl(Bucket="surveys", Key="a.laz", ACL="public-read")
        local = products(self.run_cloud(self.files / "a.laz", "local"))
        stored = self.run_cloud(f"http://127.0.0.1:{self.proxy.port}/surveys/a.laz", "stored")
        self.assertEqual(local, products(stored))

    def test_check(self):
        done = swath("check", CLOUD, "--survey", self.cloud("s3://surveys/a.copc.laz", self.folder))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.refused("check", CLOUD, "--survey", self.cloud("s3://surveys/none.laz", self.folder), says="key does not exist",
                     where="s3://surveys/none.laz")

    def test_a_changed_object_is_a_new_run(self):
        self.put(self.files / "a.laz", "changing.laz")
        first = self.run_cloud("s3://surveys/changing.laz", "out", "--set", "run.keep_work=true")
        again = self.run_cloud("s3://surveys/changing.laz", "out", "--set", "run.keep_work=true")
        resumed = json.loads((again / "report.json").read_text())["pieces_resumed"]
        self.assertGreater(resumed, 0)
        before = products(first / "points")
        self.put(self.files / "a.las", "changing.laz")  # other bytes, a LAS file now
        changed = self.run_cloud("s3://surveys/changing.laz", "out", "--set", "run.keep_work=true")
        self.assertEqual(json.loads((changed / "report.json").read_text())["pieces_resumed"], 0)
        self.assertTrue(before)


class StoreFaults(StoreCase):
    @classmethod
    def make_files(cls):
        cls.make("a.laz", POINTS, cls.survey / "survey.toml", "points/*.laz")

    def test_what_is_not_there(self):
        self.refused("info", "s3://surveys/none.laz", says="key does not exist", where="s3://surveys/none.laz")
        self.refused("info", "s3://none-of-these/a.laz", says="bucket does not exist", where="s3://none-of-these/a.laz")
        survey = self.cloud("s3://surveys/none.laz", self.folder)
        self.refused("run", CLOUD, "--survey", survey, "--output", self.out, "--quiet", says="key does not exist",
                     where="s3://surveys/none.laz")
        self.assertFalse(self.out.exists())

    def test_no_credentials(self):
        self.refused("info", "s3://surveys/a.laz", says="AWS_SECRET_ACCESS_KEY", where="s3://surveys/a.laz", AWS_SECRET_ACCESS_KEY=None,
                     AWS_ACCESS_KEY_ID=None)
        self.refused("info", f"http://127.0.0.1:{self.proxy.port}/surveys/a.laz", says="403", where="/surveys/a.laz")

    def test_no_server(self):
        self.refused("info", "s3://surveys/a.laz", says="connect", where="s3://surveys/a.laz", AWS_S3_ENDPOINT="127.0.0.1:9")
        self.refused("info", "s3://surveys/a.laz", says="", where="s3://surveys/a.laz", AWS_S3_ENDPOINT="no-such-host.invalid")

    def test_a_connection_that_breaks_off(self):
        self.proxy.cut_after = 200_000
        try:
            survey = self.cloud("s3://surveys/a.laz", self.folder)
            self.refused("run", CLOUD, "--survey", survey, "--output", self.out, "--quiet", says="at byte", where="s3://surveys/a.laz")
        finally:
            self.proxy.cut_after = None
        done = swath("run", CLOUD, "--survey", survey, "--output", self.out, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_what_is_not_read_from_a_store(self):
        self.client.put_object(Bucket="surveys", Key="text.txt", Body=b"1 2 3\n")
        self.refused("info", "s3://surveys/text.txt", says="of no kind that is read from a store", where="s3://surveys/text.txt")
        survey = self.folder / "survey.toml"
        survey.write_text('crs = "EPSG:32632"\n[[points]]\nfile = "s3://surveys/a.laz"\n[[control]]\nfile = "s3://surveys/text.txt"\n')
        self.refused("check", CLOUD, "--survey", survey, says="only clouds and rasters", where="control[1].file", code=2)

    def test_names_within_files_are_not_opened(self):
        address = f"http://127.0.0.1:{self.proxy.port}/surveys/a.laz"
        vrt = self.folder / "a.vrt"
        vrt.write_text('<VRTDataset rasterXSize="2" rasterYSize="2"><VRTRasterBand dataType="Float32" band="1"><SimpleSource><SourceFilename>'
                       '/vsis3/surveys/a.tif</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>')
        text = self.folder / "a.txt"
        text.write_text(f"{address}\n/vsis3/surveys/a.laz\n")
        lists = []
        for name in ("s3://surveys/a.laz", "/vsis3/surveys/a.laz", address):
            lists.append(self.folder / f"{len(lists)}.vpc")
            lists[-1].write_text(json.dumps({"type": "FeatureCollection", "features": [{"assets": {"data": {"href": name}}}]}))
        self.proxy.reset()
        for file in (vrt, text):
            swath("info", file)
        for file in lists:
            done = swath("run", CLOUD, "--survey", self.cloud(file, self.folder), "--output", self.out)
            self.assertNotEqual(done.returncode, 0)
        self.assertEqual(self.proxy.connections, 0)


class StoreCopies(StoreCase):
    """Finished products copied to the bucket by --deliver."""

    @classmethod
    def make_files(cls):
        cls.make("a.laz", POINTS, cls.survey / "survey.toml", "points/*.laz")

    def objects(self, prefix):
        pages = self.client.get_paginator("list_objects_v2").paginate(Bucket="surveys", Prefix=prefix)
        keys = [one["Key"] for page in pages for one in page.get("Contents", [])]
        return {key[len(prefix):]: self.client.get_object(Bucket="surveys", Key=key)["Body"].read() for key in keys}

    def deliver(self, address, *more, **environment):
        cloud = self.cloud("s3://surveys/a.laz", self.folder)
        return swath("run", CLOUD, "--survey", cloud, "--output", self.out, "--deliver", address, *more, env={**os.environ, **environment})

    def test_the_bucket_has_the_products(self):
        done = self.deliver("s3://surveys/made")
        self.assertEqual(done.returncode, 0, done.stderr)
        there = self.objects("made/")
        local = {str(p.relative_to(self.out)): p.read_bytes() for p in self.out.rglob("*") if p.is_file()}
        self.assertEqual(local, there)
        self.assertIn(f"copied: {len(there)} files", done.stdout)
        self.assertIn("report.json", there)

    def test_a_copy_that_fails_is_repeated_alone(self):
        done = self.deliver("s3://none-of-these/made", "--quiet")
        self.assertEqual(done.returncode, 1, done.stderr)
        for part in ("s3://none-of-these/made/", "bucket does not exist", str(self.out)):
            self.assertIn(part, done.stderr)
        kept = products(self.out)
        report = (self.out / "report.json").read_bytes()
        self.proxy.cut_after = 0  # nothing comes back: the copies are lost
        try:
            done = self.deliver("s3://surveys/late", "--quiet")
            self.assertEqual(done.returncode, 1, done.stderr)
        finally:
            self.proxy.cut_after = None
        done = self.deliver("s3://surveys/late")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("products of the run before copied", done.stdout)
        self.assertEqual((self.out / "report.json").read_bytes(), report)
        there = self.objects("late/")
        self.assertEqual(there.pop("report.json"), report)
        self.assertEqual(there, {k: v for k, v in kept.items() if not k.startswith(".")})
        self.assertEqual(there, products(self.out))

    def test_what_is_no_store_is_refused_before_the_run(self):
        for name in ("copies", "https://127.0.0.1/made", "s3://"):
            self.refused("run", CLOUD, "--survey", self.cloud("s3://surveys/a.laz", self.folder), "--output", self.out, "--deliver", name,
                         says="not a place in an object store", where=name, code=2)
        self.assertFalse(self.out.exists())


if __name__ == "__main__":
    unittest.main()
