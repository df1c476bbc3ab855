// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/tile_store.h"

#include <random>
#include <set>

#include "core/error.h"
#include "pipeline/work/piece_record.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

using core::Block;
using core::Column;

Block cloud(size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> at(-150.0, 250.0);
  Block b;
  b.origin = {1000, 2000, 0};
  for (size_t i = 0; i < n; ++i) {
    b.x.push_back(at(random));
    b.y.push_back(at(random));
    b.z.push_back(at(random));
    b.record.push_back(static_cast<std::uint32_t>(i));
    b.classification.push_back(1);
  }
  return b;
}

struct Store {
  test::TemporaryFolder folder;
  TileStore store;
  Block all;

  explicit Store(double side = 100.0, size_t buffer = 1 << 20) : store(folder / "strips", side, {1000, 2000, 0}) {
    for (unsigned s = 1; s <= 2; ++s) {
      StripWriter writer(folder / ("strips/strip_" + std::to_string(s)), side, buffer);
      const Block part = cloud(3000, s);
      for (std::uint32_t from = 0; from < 3000; from += 700) {
        std::vector<std::uint32_t> rows;
        for (std::uint32_t i = from; i < std::min(3000u, from + 700); ++i) rows.push_back(i);
        writer.write(core::select(part, rows));
      }
      writer.commit("note " + std::to_string(s));
      core::append(all, part);
    }
    store.open({"strip_1", "strip_2"});
  }
};

TEST(TileStore, PartsOfATileHoldEachOfItsPointsOnceAndAllAroundThem) {
  const Store s;
  const TileKey key = s.store.tiles().begin()->first;
  const Block whole = s.store.read(key, {Column::record, Column::strip});
  std::vector<int> seen(whole.size(), 0);
  for (int k = 0; k < 16; ++k) {
    const TilePart part{key, 4, k % 4, k / 4};
    const stages::Box box = part.metres(100.0), around = box.grown(30.0);
    std::vector<std::uint32_t> rows;
    const Block b = s.store.read_part(part, 30.0, {Column::record, Column::strip}, rows);
    for (size_t i = 0; i < rows.size(); ++i) {
      ++seen[rows[i]];
      EXPECT_EQ(b.record[i], whole.record[rows[i]]);
      EXPECT_TRUE(box.holds(1000 + b.x[i], 2000 + b.y[i]));
    }
    size_t within = 0;
    for (size_t i = 0; i < s.all.size(); ++i) within += around.holds(1000 + s.all.x[i], 2000 + s.all.y[i]);
    EXPECT_EQ(b.size(), within);
    for (size_t i = rows.size(); i < b.size(); ++i) EXPECT_FALSE(box.holds(1000 + b.x[i], 2000 + b.y[i]));
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(whole.size()));
}

TEST(TileStore, RowsComeOneAfterTheOtherAsTheyAreRead) {
  Store s;
  for (const auto& [key, n] : s.store.tiles()) {
    Block b = s.store.read(key, {Column::classification});
    std::fill(b.classification.begin(), b.classification.end(), static_cast<std::uint8_t>(7 + key.ix));
    s.store.write_overlay(s.folder / "late", key, b, 0, b.size(), {Column::classification});
  }
  s.store.add_overlay(s.folder / "late", {Column::classification});
  const core::ColumnSet columns{Column::record, Column::classification, Column::strip};
  for (const auto& [key, n] : s.store.tiles()) {
    const Block whole = s.store.read(key, columns);
    Block all;
    s.store.each_rows(key, columns, [&](Block& b) {
      EXPECT_EQ(core::columns_of(b), core::columns_of(whole));
      core::append(all, b);
    });
    EXPECT_EQ(all.x, whole.x);
    EXPECT_EQ(all.record, whole.record);
    EXPECT_EQ(all.classification, whole.classification);
  }
}

TEST(TileStore, RowsOfBytesComeBackWithTheirPoints) {
  const test::TemporaryFolder folder;
  const auto byte_of = [](unsigned strip, std::uint32_t record, size_t k) {
    const std::uint32_t value = k == 0 ? strip : k == 1 ? record : k == 2 ? record >> 8 : 0;
    return static_cast<std::uint8_t>(strip == 2 ? 0 : value);
  };
  for (unsigned s = 1; s <= 3; ++s) {  // rows of 3 bytes, none, rows of 5
    Block part = cloud(2000, s);
    part.strip.assign(part.size(), static_cast<std::uint16_t>(s));
    for (size_t i = 0; s != 2 && i < part.size(); ++i) {
      part.source.resize(i + 1, s == 1 ? 3 : 5);
      for (size_t k = 0; k < 3; ++k) part.source.row(i)[k] = byte_of(s, part.record[i], k);
    }
    StripWriter writer(folder / ("strips/strip_" + std::to_string(s)), 100.0, 1 << 16);
    writer.write(part);
    writer.commit("");
  }
  TileStore store(folder / "strips", 100.0, {1000, 2000, 0});
  store.open({"strip_1", "strip_2", "strip_3"});
  EXPECT_EQ(store.source_width(), 5u);
  const auto expect_rows = [&](const Block& b) {
    ASSERT_EQ(b.source.size(), b.size());
    for (size_t i = 0; i < b.size(); ++i)
      for (size_t k = 0; k < 5; ++k) ASSERT_EQ(b.source.row(i)[k], byte_of(b.strip[i], b.record[i], k)) << i;
  };
  for (const auto& [key, n] : store.tiles()) {
    expect_rows(store.read(key, {Column::record, Column::strip, Column::source}));
    EXPECT_TRUE(store.read(key, {Column::record}).source.empty());
    size_t own = 0;
    expect_rows(store.read_with_halo({key}, 20.0, {Column::record, Column::strip, Column::source}, own));
  }
}

TEST(TileStore, PointsThatAreReleasedAreGoneAndTheOthersStay) {
  Store s;
  const auto first = *s.store.tiles().begin(), last = *s.store.tiles().rbegin();
  s.store.release(first.first);
  EXPECT_THROW(s.store.read(first.first, {}), core::SystemError);
  EXPECT_EQ(s.store.read(last.first, {}).size(), last.second);
  EXPECT_EQ(TileStore::released(s.folder / "strips/strip_1"), std::vector<TileKey>{first.first});
  TileStore again(s.folder / "strips", 100.0, {1000, 2000, 0});
  again.open({"strip_1", "strip_2"});
  EXPECT_EQ(again.points(), s.store.points());
  EXPECT_EQ(again.tiles(), s.store.tiles());
  EXPECT_EQ(again.columns(), s.store.columns());
}

TEST(TileStore, HoldsEveryPointOnceInTheOrderOfRecords) {
  for (const size_t buffer : {size_t{1}, size_t{1} << 20}) {
    const Store s(100.0, buffer);
    EXPECT_EQ(s.store.points(), 6000u);
    size_t seen = 0;
    for (const auto& [key, n] : s.store.tiles()) {
      const Block b = s.store.read(key, {Column::record, Column::classification});
      EXPECT_EQ(b.size(), n);
      EXPECT_EQ(b.record.size(), n);
      int restarts = 0;
      for (size_t i = 1; i < b.size(); ++i) restarts += b.record[i] <= b.record[i - 1];
      EXPECT_LE(restarts, 1) << "records of the second strip follow those of the first";
      seen += n;
    }
    EXPECT_EQ(seen, 6000u);
  }
}

TEST(TileStore, ReadsOnlyTheColumnsAskedFor) {
  const Store s;
  const Block b = s.store.read(s.store.tiles().begin()->first, {Column::record});
  EXPECT_FALSE(b.record.empty());
  EXPECT_TRUE(b.classification.empty());
  EXPECT_EQ(b.x.size(), b.size());
}

TEST(TileStore, AColumnOfOneStripIsZeroInTheOthers) {
  const test::TemporaryFolder folder;
  for (const int s : {1, 2, 3}) {
    StripWriter writer(folder / ("strips/strip_" + std::to_string(s)), 1000.0, 1);
    Block part = cloud(100, 1);
    if (s == 2) part.red.assign(part.size(), 7);
    writer.write(part);
    writer.commit("");
  }
  TileStore store(folder / "strips", 1000.0, {1000, 2000, 0});
  store.open({"strip_1", "strip_2", "strip_3"});
  EXPECT_TRUE(store.columns().has(Column::red));
  size_t coloured = 0;
  for (const auto& [key, n] : store.tiles()) {
    const Block b = store.read(key, {Column::red, Column::record});
    ASSERT_EQ(b.red.size(), n);
    for (size_t i = 0; i < n; ++i) coloured += b.red[i] == 7;
    EXPECT_EQ(b.red.back(), 0);
  }
  EXPECT_EQ(coloured, 100u);
}

TEST(TileStore, HaloHoldsExactlyThePointsAroundTheBox) {
  const Store s;
  const double halo = 130.0;
  for (const auto& [key, n] : s.store.tiles()) {
    size_t own = 0;
    const Block b = s.store.read_with_halo({key}, halo, {}, own);
    EXPECT_EQ(own, n);
    const stages::Box box = stages::Box{key.ix * 100.0, key.iy * 100.0, key.ix * 100.0 + 100, key.iy * 100.0 + 100}.grown(halo);
    size_t inside = 0;
    for (size_t i = 0; i < s.all.size(); ++i) inside += box.holds(1000 + s.all.x[i], 2000 + s.all.y[i]);
    EXPECT_EQ(b.size(), inside);
    EXPECT_GE(s.store.load_with_halo({key}, halo).points * 10, b.size() * 8);
  }
}

TEST(TileStore, JoinedTilesComeOneAfterTheOtherWithOneHalo) {
  const Store s;
  const double halo = 30.0;
  const std::vector<TileKey> keys = {s.store.tiles().begin()->first, std::next(s.store.tiles().begin())->first};
  stages::Box box{1e9, 1e9, -1e9, -1e9};
  for (const TileKey k : keys)
    box = {std::min(box.x0, k.ix * 100.0), std::min(box.y0, k.iy * 100.0), std::max(box.x1, k.ix * 100.0 + 100),
           std::max(box.y1, k.iy * 100.0 + 100)};
  size_t own = 0, at = 0;
  const Block b = s.store.read_with_halo(keys, halo, {Column::record}, own);
  for (const TileKey k : keys)
    for (const auto record : s.store.read(k, {Column::record}).record) ASSERT_EQ(b.record[at++], record);
  EXPECT_EQ(own, at);
  size_t inside = 0;
  for (size_t i = 0; i < s.all.size(); ++i) inside += box.grown(halo).holds(1000 + s.all.x[i], 2000 + s.all.y[i]);
  EXPECT_EQ(b.size(), inside);
  EXPECT_GE(s.store.load_with_halo(keys, halo).points * 10, b.size() * 8);
}

TEST(TileStore, AStageMayTakePointsOutOfTheHalo) {
  const Store s;
  const TileKey key = s.store.tiles().begin()->first;
  size_t own = 0, thinned_own = 0;
  const Block all = s.store.read_with_halo({key}, 130.0, {Column::record}, own);
  const Block b = s.store.read_with_halo({key}, 130.0, {Column::record}, thinned_own, [](Block& part) {
    std::vector<std::uint32_t> rows;
    for (std::uint32_t i = 0; i < part.size(); ++i)
      if (part.record[i] % 2 == 0) rows.push_back(i);
    part = core::select(part, rows);
  });
  EXPECT_EQ(thinned_own, own);
  // Their order may be another.
  std::multiset<std::pair<std::uint32_t, double>> expected, thinned;
  for (size_t i = own; i < all.size(); ++i)
    if (all.record[i] % 2 == 0) expected.insert({all.record[i], all.x[i]});
  for (size_t i = own; i < b.size(); ++i) thinned.insert({b.record[i], b.x[i]});
  EXPECT_TRUE(thinned == expected);
  for (size_t i = 0; i < own; ++i) ASSERT_EQ(b.record[i], all.record[i]);
  EXPECT_LT(b.size(), all.size());
}

TEST(TileStore, OverlaysReplaceColumns) {
  Store s;
  std::filesystem::create_directories(s.folder / "overlay");
  for (const auto& [key, n] : s.store.tiles()) {
    size_t own = 0;
    Block b = s.store.read_with_halo({key}, 50, {Column::classification}, own);
    for (auto& c : b.classification) c = 2;
    const PieceFile made = s.store.write_overlay(s.folder / "overlay", key, b, 0, own, {Column::classification});
    const PieceFile read = piece_file(s.folder / "overlay", s.folder / "overlay" / made.name);
    EXPECT_EQ(made.bytes, read.bytes);
    EXPECT_EQ(made.checksum, read.checksum);
  }
  s.store.add_overlay(s.folder / "overlay", {Column::classification});
  for (const auto& [key, n] : s.store.tiles()) {
    const Block b = s.store.read(key, {Column::classification, Column::record});
    EXPECT_EQ(b.classification, std::vector<std::uint8_t>(n, 2));
    EXPECT_EQ(b.record.size(), n);
  }
}

TEST(TileStore, AnOverlayOfHeightsIsTheSameHoweverItIsRead) {
  const test::TemporaryFolder folder;
  const Eigen::Vector3d origin{1000, 2000, 400};
  TileStore store(folder / "strips", 100.0, origin);
  Block points;
  points.origin = origin;
  for (int i = 0; i < 100; ++i) points.x.push_back(i + 0.25), points.y.push_back(i + 0.25), points.z.push_back(0.001 * i);
  StripWriter writer(folder / "strips/strip_1", 100.0, 1 << 20);
  writer.write(points);
  writer.commit("");
  store.open({"strip_1"});
  const TileKey key = store.tiles().begin()->first;
  for (double& z : points.z) z += 7.0;
  std::filesystem::create_directories(folder / "overlay");
  store.write_overlay(folder / "overlay", key, points, 0, points.size(), {Column::z});
  store.add_overlay(folder / "overlay", {Column::z});
  EXPECT_EQ(store.read(key, {Column::z}).z, points.z);
  std::vector<double> rows;
  store.each_rows(key, {Column::z}, [&](Block& b) { rows.insert(rows.end(), b.z.begin(), b.z.end()); });
  EXPECT_EQ(rows, points.z);
  std::vector<std::uint32_t> numbers;
  EXPECT_EQ(store.read_part({key, 1, 0, 0}, 0.0, {Column::z}, numbers).z, points.z);
}

TEST(TileStore, AnUncommittedStripLeavesNothing) {
  const test::TemporaryFolder folder;
  {
    StripWriter writer(folder / "strips/strip_1", 100, 1);
    writer.write(cloud(100, 1));
  }
  EXPECT_EQ(test::entries(folder / "strips"), 0u);
  EXPECT_FALSE(TileStore::is_committed(folder / "strips/strip_1"));
}

TEST(TileStore, ACutFileIsAnError) {
  Store s;
  const auto key = s.store.tiles().begin()->first;
  const auto file = s.folder / ("strips/strip_1/" + file_label(key) + ".pts");
  const std::string bytes = test::read_bytes(file);
  test::write_bytes(file, bytes.substr(0, bytes.size() - 5));
  EXPECT_THROW(s.store.read(key, {Column::record, Column::classification}), core::Error);
}

TEST(TileStore, AnOverlayThatIsEmptyCutOrGoneIsAnError) {
  Store s;
  std::filesystem::create_directories(s.folder / "overlay");
  for (const auto& [key, n] : s.store.tiles()) {
    const Block b = s.store.read(key, {Column::classification});
    s.store.write_overlay(s.folder / "overlay", key, b, 0, n, {Column::classification});
  }
  s.store.add_overlay(s.folder / "overlay", {Column::classification});
  const auto key = s.store.tiles().begin()->first;
  const auto file = s.folder / ("overlay/" + file_label(key) + ".cols");
  const auto expect_error = [&] {
    size_t own = 0;
    EXPECT_THROW(s.store.read(key, {Column::classification}), core::SystemError);
    EXPECT_THROW(s.store.read_with_halo({{key.ix + 1, key.iy}}, 50, {Column::classification}, own), core::SystemError);
  };
  const std::string bytes = test::read_bytes(file);
  test::write_bytes(file, "");
  expect_error();
  test::write_bytes(file, bytes.substr(0, bytes.size() - 1));
  expect_error();
  std::filesystem::remove(file);
  expect_error();
}

TEST(TileStore, AStripsRecordKnowsItsFiles) {
  Store s;
  const auto strip = s.folder / "strips/strip_1";
  const auto record = read_record(strip / "strip.json");
  ASSERT_TRUE(record);
  EXPECT_TRUE(is_whole(*record, strip));
  std::string bytes = test::read_bytes(strip / record->files[0].name);
  bytes[bytes.size() / 2] ^= 1;
  test::write_bytes(strip / record->files[0].name, bytes);
  EXPECT_FALSE(is_whole(*record, strip));
}

}  // namespace
}  // namespace swath::pipeline
