// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/copc/copc_hierarchy.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "core/error.h"
#include "io/las/las_bytes.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

constexpr std::uint32_t points_at = 600;

/// All nodes of the first levels, each of a few points and 10 bytes.
std::vector<CopcNode> made_nodes(int levels) {
  std::vector<CopcNode> nodes{{{}, points_at + 8, 10, 3, 0}};
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].key.level + 1 < levels)
      for (int octant = 0; octant < 8; ++octant)
        nodes.push_back(
            {nodes[i].key.child(octant), points_at + 8 + 10 * nodes.size(), 10, static_cast<std::int32_t>(nodes.size() % 5 + 1), 0});
  return nodes;
}

struct Written {
  LasHeader header;
  CopcInfo info;
  std::filesystem::path file;
};

/// A file whose points are zeros, with the pages of the nodes behind them.
Written write_pages(const test::TemporaryFolder& folder, const std::vector<CopcNode>& nodes) {
  Written w;
  w.file = folder / "a.copc.laz";
  w.header.offset_to_points = points_at;
  for (const CopcNode& n : nodes) w.header.point_count += static_cast<std::uint64_t>(n.points);
  const std::uint64_t place = points_at + 8 + 10 * nodes.size();
  const std::vector<std::uint8_t> pages = copc_pages(nodes, place, w.info);
  std::ofstream out(w.file, std::ios::binary);
  out << std::string(place, '\0');
  out.write(reinterpret_cast<const char*>(pages.data()), static_cast<std::streamsize>(pages.size()));
  return w;
}

TEST(CopcHierarchy, InfoComesBack) {
  CopcInfo info{{{1.5, -2.5, 300.0}, 512.25}, 4.0, 1234567890123u, 64, 1.25e8, 1.5e8};
  LasHeader h;
  h.vlrs = {copc_info_record(info)};
  EXPECT_EQ(h.vlrs[0].data.size(), 160u);
  const auto back = copc_info(h, "a");
  ASSERT_TRUE(back);
  EXPECT_EQ(back->cube.centre, info.cube.centre);
  EXPECT_EQ(back->cube.half_side, info.cube.half_side);
  EXPECT_EQ(back->spacing, info.spacing);
  EXPECT_EQ(back->page, info.page);
  EXPECT_EQ(back->page_bytes, info.page_bytes);
  EXPECT_EQ(back->first_time, info.first_time);
  EXPECT_EQ(back->last_time, info.last_time);
  EXPECT_FALSE(copc_info(LasHeader{}, "a"));
  h.vlrs[0].data.resize(159);
  EXPECT_THROW(copc_info(h, "a"), core::Error);
  info.cube.half_side = 0.0;
  h.vlrs[0] = copc_info_record(info);
  EXPECT_THROW(copc_info(h, "a"), core::Error);
}

TEST(CopcHierarchy, NodesComeBackInOrderWithTheNumberOfTheirFirstPoint) {
  const test::TemporaryFolder folder;
  const std::vector<CopcNode> nodes = made_nodes(3);
  const Written w = write_pages(folder, nodes);
  EXPECT_EQ(w.info.page_bytes, 32u * nodes.size()) << "one page";
  const std::vector<CopcNode> back = read_copc_nodes(w.file, w.header, w.info);
  ASSERT_EQ(back.size(), nodes.size());
  std::uint64_t first = 0;
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_EQ(back[i].key, nodes[i].key);
    EXPECT_EQ(back[i].offset, nodes[i].offset);
    EXPECT_EQ(back[i].first_record, first);
    first += static_cast<std::uint64_t>(nodes[i].points);
  }
}

TEST(CopcHierarchy, ManyNodesHaveSeveralPages) {
  const test::TemporaryFolder folder;
  const std::vector<CopcNode> nodes = made_nodes(6);  // 37 449
  const Written w = write_pages(folder, nodes);
  EXPECT_LT(w.info.page_bytes, 32u * 8192u);
  EXPECT_EQ(read_copc_nodes(w.file, w.header, w.info).size(), nodes.size());
}

TEST(CopcHierarchy, EveryFaultIsOneErrorThatNamesIt) {
  const test::TemporaryFolder folder;
  using las::put;
  struct Case {
    const char* expected;
    std::size_t entry;
    std::size_t byte;
    std::int64_t value;
    std::size_t bytes;
  };
  const std::vector<Case> cases{
      {"does not fit the file", 3, 16, 1 << 30, 8},  // offset
      {"does not fit the file", 3, 24, -5, 4},       // size
      {"does not fit the file", 3, 28, -7, 4},       // points
      {"begins within another", 3, 24, 15, 4},       // longer than the gap to the next
      {"begins within another", 1, 16, 20, 8},       // in the header
      {"nodes hold", 4, 28, 77, 4},                  // other points than the header counts
      {"'1-2-", 4, 4, 2, 4},                         // x outside the level
      {"'99-", 4, 0, 99, 4},                         // level
      {"is listed twice", 2, 4, 0, 4},               // the key of the entry before it
      {"has no parent", 0, 0, 9, 4},                 // the root becomes another node
      {"a page is listed twice", 2, 28, -1, 4},      // a page that is the root's: see below
  };
  for (const Case& c : cases) {
    const Written w = write_pages(folder, made_nodes(2));
    std::fstream f(w.file, std::ios::in | std::ios::out | std::ios::binary);
    const auto at = static_cast<std::streamoff>(w.info.page + 32 * c.entry);
    f.seekp(at + static_cast<std::streamoff>(c.byte));
    f.write(reinterpret_cast<const char*>(&c.value), static_cast<std::streamsize>(c.bytes));
    if (std::string(c.expected).starts_with("a page")) {
      f.seekp(at + 16);
      f.write(reinterpret_cast<const char*>(&w.info.page), 8);
      const std::int32_t size = 32;
      f.write(reinterpret_cast<const char*>(&size), 4);
    }
    f.close();
    try {
      read_copc_nodes(w.file, w.header, w.info);
      ADD_FAILURE() << "not refused: " << c.expected;
    } catch (const core::Error& e) {
      EXPECT_NE(std::string(e.what()).find("the COPC hierarchy is broken"), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find(c.expected), std::string::npos) << e.what();
    }
  }
  Written w = write_pages(folder, made_nodes(2));
  w.info.page_bytes += 1;
  EXPECT_THROW(read_copc_nodes(w.file, w.header, w.info), core::Error);
  w.info.page_bytes -= 1, w.info.page += 1u << 30;
  EXPECT_THROW(read_copc_nodes(w.file, w.header, w.info), core::Error);
}

}  // namespace
}  // namespace swath::io
