// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/store/input_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <numeric>
#include <utility>

#include "core/error.h"
#include "io/copc/copc_hierarchy.h"
#include "io/las/describe_las.h"
#include "io/raster/geotiff.h"
#include "io/text/value_file.h"
#include "tests/io/copc/copc_sample.h"
#include "tests/io/store/memory_object.h"

namespace swath::io {
namespace {

std::string part(InputFile& file, std::uint64_t at, size_t n) {
  std::string out(n, '\1');
  out.resize(file.read_some(at, out.data(), n));
  return out;
}

TEST(InputFile, LocalFilesAndObjectsGiveTheSameBytes) {
  const test::TemporaryFolder folder;
  std::string bytes;
  for (int i = 0; i < 20000; ++i) bytes += std::to_string(i);
  test::write_bytes(folder / "a.bin", bytes);
  const test::MemoryObject object("input_file_test/a.bin", bytes);
  InputFile local(folder / "a.bin"), stored(object.address());
  EXPECT_EQ(local.size(), bytes.size());
  EXPECT_EQ(stored.size(), bytes.size());
  for (const std::uint64_t at :
       {std::uint64_t{40000}, std::uint64_t{0}, std::uint64_t{17}, bytes.size() - 3, bytes.size(), bytes.size() + 9})
    for (const size_t n : {size_t{0}, size_t{1}, size_t{4096}}) {
      const std::string wanted = at < bytes.size() ? bytes.substr(at, n) : "";
      EXPECT_TRUE(part(local, at, n) == wanted) << at;
      EXPECT_TRUE(part(stored, at, n) == wanted) << at;
    }
  InputFile moved(std::move(local));
  moved = std::move(stored);
  EXPECT_EQ(moved.path(), object.address());
  EXPECT_EQ(part(moved, 0, 2), "01");
}

TEST(InputFile, WhatIsNoFileIsAnError) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(InputFile(folder / "none"), core::Error);
  EXPECT_THROW(InputFile(folder.path()), core::Error);
  EXPECT_THROW(InputFile("/vsimem/input_file_test/none"), core::Error);
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(InputFile(folder / "pipe"), core::Error);  // and does not wait for a writer
}

TEST(InputFile, CloudsInAStoreHaveThePointsOfLocalOnes) {
  const test::TemporaryFolder folder;
  for (const int format : {1, 6, 7}) {
    const LasHeader h = test::sample_header(format);
    const LasPoints p = test::sample_points(h, 120000);
    for (const char* name : {"a.las", "a.laz"}) {
      test::write_sample(folder / name, h, p);
      const test::MemoryObject object(std::string("input_file_test/") + name, test::read_bytes(folder / name));
      for (const unsigned threads : {1u, 3u}) EXPECT_TRUE(test::read_all(object.address(), threads) == p) << name << " " << format;
    }
  }
}

TEST(InputFile, ACutCloudInAStoreIsAnErrorWithItsAddress) {
  const test::TemporaryFolder folder;
  const LasHeader h = test::sample_header(6);
  for (const char* name : {"b.las", "b.laz"}) {
    test::write_sample(folder / name, h, test::sample_points(h, 60000));
    const std::string bytes = test::read_bytes(folder / name);
    const test::MemoryObject object(std::string("input_file_test/") + name, bytes.substr(0, bytes.size() / 2));
    try {
      test::read_all(object.address());
      FAIL() << name;
    } catch (const core::Error& e) {
      EXPECT_EQ(e.where().find(object.address().string()), 0u) << e.text();
    }
  }
}

TEST(InputFile, TheNodesOfACopcInAStoreAreReadAlone) {
  const test::TemporaryFolder folder;
  LasHeader h = test::sample_header(6);
  test::write_copc_sample(folder / "a.copc.laz", h, test::copc_points(h, 200000));
  const test::MemoryObject object("input_file_test/a.copc.laz", test::read_bytes(folder / "a.copc.laz"));
  std::vector<std::string> warnings;
  const LasHeader read = read_las_header(object.address(), warnings);
  const auto nodes = read_copc_nodes(object.address(), read, *copc_info(read, object.address()));
  ASSERT_GT(nodes.size(), 2u);
  const CopcNode& n = nodes[nodes.size() / 2];
  const LasPart some{
      std::vector<LasChunk>{{n.offset, static_cast<std::uint64_t>(n.bytes), static_cast<std::uint64_t>(n.points), n.first_record}}};
  LasReader local(folder / "a.copc.laz", 1, some), stored(object.address(), 1, some);
  LasPoints a, b;
  EXPECT_EQ(local.read(a, 1000000), static_cast<size_t>(n.points));
  stored.read(b, 1000000);
  EXPECT_TRUE(a == b);
}

TEST(InputFile, AnObjectIsDescribedByItsHeader) {
  const test::TemporaryFolder folder;
  const LasHeader h = test::sample_header(6);
  test::write_sample(folder / "c.laz", h, test::sample_points(h, 5000));
  const test::MemoryObject object("input_file_test/c.laz", test::read_bytes(folder / "c.laz"));
  const core::Value whole = describe_las(folder / "c.laz"), head = describe_las(object.address());
  for (const char* key : {"format", "version", "points", "returns"}) EXPECT_EQ(to_json(*whole.find(key)), to_json(*head.find(key))) << key;
  EXPECT_EQ(head.find("classes"), nullptr);
  EXPECT_EQ(whole.find("read"), nullptr);
  EXPECT_NE(head.find("read")->as_text().find("header alone"), std::string::npos);
}

TEST(InputFile, ARasterInAStoreIsReadAndNamesWithinAVirtualOneAreNot) {
  const test::TemporaryFolder folder;
  core::Lattice lattice;
  lattice.nx = 40, lattice.ny = 30;
  core::Grid grid(lattice);
  std::iota(grid.height.begin(), grid.height.end(), 7.5F);
  write_grid(folder / "a.tif", grid, "EPSG:25832");
  const test::MemoryObject object("input_file_test/a.tif", test::read_bytes(folder / "a.tif"));
  const Raster local = read_raster(folder / "a.tif"), stored = read_raster(object.address());
  EXPECT_EQ(local.values, stored.values);
  const test::MemoryObject list(
      "input_file_test/a.vrt",
      "<VRTDataset rasterXSize=\"40\" rasterYSize=\"30\"><VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource>"
      "<SourceFilename relativeToVRT=\"1\">a.tif</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>");
  EXPECT_THROW(read_raster(list.address()), core::Error);
  EXPECT_THROW(read_raster("/vsimem/input_file_test/none.tif"), core::Error);
}

}  // namespace
}  // namespace swath::io
