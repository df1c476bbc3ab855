// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/copc/copc_writer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "core/error.h"
#include "io/copc/copc_hierarchy.h"
#include "tests/io/copc/copc_sample.h"
#include "tests/io/file_size_limit.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Records in an order that does not depend on that of the points.
std::vector<std::string> sorted_records(const LasPoints& p, LasHeader h) {
  const std::vector<std::uint8_t> all = test::records_of(p, h);
  std::vector<std::string> out;
  for (std::size_t at = 0; at < all.size(); at += h.record_length)
    out.emplace_back(reinterpret_cast<const char*>(&all[at]), static_cast<std::size_t>(h.record_length));
  std::sort(out.begin(), out.end());
  return out;
}

TEST(CopcWriter, EveryFieldOfEveryPointComesBackInEachPointFormat) {
  for (const int format : {6, 7, 8}) {
    const test::TemporaryFolder folder;
    LasHeader h = test::sample_header(format, 4, true);
    h.vlrs.push_back({"test", 9, "kept", {1, 2, 3}, 0, 0});
    h.evlrs.push_back({"LASF_Projection", 2112, "a CRS behind the points", {'W', 0}, 0, 0});
    h.evlrs.push_back({"test", 10, "kept", {4, 5}, 0, 0});
    const LasPoints p = test::copc_points(h, 20000);
    const CopcWritten written = test::write_copc_sample(folder / "a.copc.laz", h, p);
    EXPECT_EQ(written.points, 20000u);
    LasReader r(folder / "a.copc.laz");
    LasPoints back;
    r.read(back, 20000);
    EXPECT_EQ(sorted_records(back, h), sorted_records(p, h)) << format;
    const LasHeader& b = r.header();
    EXPECT_EQ(b.point_format, format);
    EXPECT_TRUE(r.warnings().empty()) << r.warnings().front();
    EXPECT_EQ(b.vlrs[0].user_id, "copc");
    EXPECT_EQ(b.vlrs[0].offset, 375u + 54u) << "where COPC readers look for it";
    EXPECT_EQ(b.vlrs[1].data, h.vlrs[0].data);
    const auto is_crs = [](const LasVlr& v) { return v.record_id == 2112; };
    EXPECT_EQ(std::count_if(b.vlrs.begin(), b.vlrs.end(), is_crs), 1);
    EXPECT_EQ(b.evlrs[0].record_id, 1000);
    EXPECT_EQ(b.evlrs.back().data, h.evlrs.back().data);
    const auto info = copc_info(b, "a");
    ASSERT_TRUE(info);
    const auto [first, last] = std::minmax_element(p.gps_time.begin(), p.gps_time.end());
    EXPECT_EQ(info->first_time, *first);
    EXPECT_EQ(info->last_time, *last);
    EXPECT_EQ(*std::min_element(p.z.begin(), p.z.end()), b.min.z());
    EXPECT_EQ(*std::max_element(p.x.begin(), p.x.end()), b.max.x());
    std::uint64_t returns = 0;
    for (const std::uint64_t n : b.by_return) returns += n;
    EXPECT_EQ(returns, 20000u);
  }
}

TEST(CopcWriter, EachNodeHoldsThePointsOfItsCubeInOrderOfTime) {
  const test::TemporaryFolder folder;
  const LasHeader h = test::sample_header(6, 4, true);
  const CopcWritten written = test::write_copc_sample(folder / "a.copc.laz", h, test::copc_points(h, 250000));
  LasReader r(folder / "a.copc.laz");
  const auto info = copc_info(r.header(), "a");
  ASSERT_TRUE(info);
  const std::vector<CopcNode> nodes = read_copc_nodes(folder / "a.copc.laz", r.header(), *info);
  EXPECT_EQ(written.nodes, nodes.size());
  EXPECT_EQ(written.levels, 2);
  LasPoints p;
  for (const CopcNode& n : nodes) {
    ASSERT_EQ(r.read(p, static_cast<std::size_t>(n.points)), static_cast<std::size_t>(n.points));
    const OctreeCube cube = info->cube.of(n.key);
    for (std::size_t i = 0; i < p.size(); ++i) {
      ASSERT_LE((Eigen::Vector3d(p.x[i], p.y[i], p.z[i]) - cube.centre).cwiseAbs().maxCoeff(), cube.half_side) << n.key.text();
      if (i > 0) {
        ASSERT_LE(p.gps_time[i - 1], p.gps_time[i]);
      }
    }
  }
}

TEST(CopcWriter, BytesDependNeitherOnOrderNorMemoryNorThreads) {
  const test::TemporaryFolder folder;
  LasHeader h = test::sample_header(7, 4, true);
  const LasPoints p = test::copc_points(h, 450000);
  std::vector<std::uint8_t> records = test::records_of(p, h), turned(records.size());
  const std::size_t n = p.size(), length = h.record_length;
  for (std::size_t i = 0; i < n; ++i) std::copy_n(&records[i * length], length, &turned[(n - 1 - i) * length]);
  turned.resize(turned.size() + length);  // one point twice, in both
  records.insert(records.end(), records.begin(), records.begin() + static_cast<std::ptrdiff_t>(length));
  std::copy_n(records.begin(), length, turned.end() - static_cast<std::ptrdiff_t>(length));
  const auto write = [&](const std::string& name, const std::vector<std::uint8_t>& from, double memory, unsigned threads) {
    write_copc(folder / name, h, test::stream_of(from, length), {folder.path(), memory, threads});
    return bytes_of(folder / name);
  };
  const std::string one = write("1.copc.laz", records, 1e9, 1);
  EXPECT_TRUE(one == write("2.copc.laz", records, 1e9, 2)) << "threads";
  EXPECT_TRUE(one == write("3.copc.laz", turned, 1e9, 2)) << "order";
  EXPECT_TRUE(one == write("4.copc.laz", records, 1e7, 1)) << "memory: five buckets in place of one";
}

TEST(CopcWriter, ACloudWithoutPointsIsAFileToo) {
  const test::TemporaryFolder folder;
  const LasHeader h = test::sample_header(6);
  EXPECT_EQ(test::write_copc_sample(folder / "a.copc.laz", h, test::copc_points(h, 0)).nodes, 0u);
  LasReader r(folder / "a.copc.laz");
  EXPECT_EQ(r.header().point_count, 0u);
  EXPECT_TRUE(read_copc_nodes(folder / "a.copc.laz", r.header(), *copc_info(r.header(), "a")).empty());
  test::write_copc_sample(folder / "b.copc.laz", h, test::copc_points(h, 1));
  EXPECT_EQ(test::read_all(folder / "b.copc.laz").size(), 1u);
}

TEST(CopcWriter, OtherPointFormatsAreRefusedAndNothingIsLeft) {
  const test::TemporaryFolder folder;
  const LasHeader h = test::sample_header(3);
  const LasPoints p = test::copc_points(h, 10);
  EXPECT_THROW(test::write_copc_sample(folder / "a.copc.laz", h, p), core::Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(CopcWriter, AFullDiskIsAnErrorAndNothingIsLeft) {
  const test::TemporaryFolder folder;
  const LasHeader h = test::sample_header(6, 4, true);
  const LasPoints p = test::copc_points(h, 50000);
  {
    const test::FileSizeLimit limit(200000);
    EXPECT_THROW(test::write_copc_sample(folder / "a.copc.laz", h, p), core::Error);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace swath::io
