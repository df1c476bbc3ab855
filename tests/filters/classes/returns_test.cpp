// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/returns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/config/option_visitors.h"

namespace swath::filters {
namespace {

struct Row {
  double time;
  int number, count;
  float range;
};

core::Block block_of(const std::vector<Row>& rows, bool with_range = true) {
  core::Block b;
  core::resize(b, rows.size());
  for (const Row& r : rows) {
    b.time.push_back(r.time);
    b.return_number.push_back(static_cast<std::uint8_t>(r.number));
    b.return_count.push_back(static_cast<std::uint8_t>(r.count));
    if (with_range) b.range.push_back(r.range);
    b.strip.push_back(3);
  }
  return b;
}

std::vector<int> numbers(const core::Block& b) { return {b.return_number.begin(), b.return_number.end()}; }

TEST(Returns, CoarseOrAbsentTimesDoNotTellPulses) {
  std::vector<Row> rows, coarse, zero;
  for (int i = 0; i < 600; ++i) {
    rows.push_back({i / 2 * 1e-5, 0, 0, 500});  // numbers lost, two returns a pulse
    coarse.push_back({static_cast<double>(i / 100), 1, 1, 500});
    zero.push_back({0.0, 0, 0, 500});
  }
  EXPECT_TRUE(tells_pulses(block_of(rows)));
  EXPECT_FALSE(tells_pulses(block_of(coarse)));
  EXPECT_FALSE(tells_pulses(block_of(zero)));
  rows[6].number = rows[7].number = 1;  // one pulse of 300 is broken: no reason to leave the others
  EXPECT_TRUE(tells_pulses(block_of(rows)));
  for (Row& r : rows) r.number = 1;
  EXPECT_FALSE(tells_pulses(block_of(rows)));
  core::Block untimed = block_of(rows);
  untimed.time.clear();
  EXPECT_FALSE(tells_pulses(untimed));
}

TEST(Returns, SoundPulsesStayAsTheyAre) {
  core::Block b = block_of({{1, 1, 1, 500}, {2, 1, 2, 480}, {2, 2, 2, 500}, {3, 2, 2, 500}, {3, 1, 2, 490}});
  EXPECT_EQ(repair_returns(b, {}), (RepairCounts{.pulses = 3}));
  EXPECT_EQ(numbers(b), (std::vector<int>{1, 1, 2, 2, 1}));
  EXPECT_EQ(b.flags, std::vector<std::uint16_t>(5, 0));
}

TEST(Returns, EachKindOfFaultIsMendedByRange) {
  const std::vector<std::vector<Row>> faults{
      {{1, 0, 0, 500}, {1, 0, 0, 480}},  // missing
      {{1, 3, 2, 500}, {1, 1, 2, 480}},  // number over count
      {{1, 1, 2, 500}, {1, 1, 2, 480}},  // twice the same
      {{1, 3, 3, 500}, {1, 1, 3, 480}},  // gap
      {{1, 1, 2, 500}, {1, 2, 2, 480}},  // order against the ranges
      {{1, 2, 2, 500}, {1, 1, 3, 480}},  // counts that differ
  };
  for (const auto& rows : faults) {
    core::Block b = block_of(rows);
    const RepairCounts n = repair_returns(b, {});
    EXPECT_EQ(n.repaired_pulses, 1u);
    EXPECT_EQ(n.inconsistent, 0u);
    EXPECT_EQ(numbers(b), (std::vector<int>{2, 1}));
    EXPECT_EQ(b.return_count, (std::vector<std::uint8_t>{2, 2}));
    EXPECT_EQ(std::count(b.flags.begin(), b.flags.end(), core::flag::returns_repaired), static_cast<long>(n.repaired));
    EXPECT_GT(n.repaired, 0u);
    core::Block again = b;
    EXPECT_EQ(repair_returns(again, {}), (RepairCounts{.pulses = 1}));
  }
}

TEST(Returns, WithoutRangesTheNumbersOrTheRowsGiveTheOrder) {
  core::Block gap = block_of({{1, 5, 5, 0}, {1, 2, 5, 0}, {1, 1, 5, 0}}, false);
  repair_returns(gap, {});
  EXPECT_EQ(numbers(gap), (std::vector<int>{3, 2, 1}));
  core::Block twice = block_of({{1, 2, 3, 0}, {1, 2, 3, 0}, {1, 1, 3, 0}}, false);
  repair_returns(twice, {});
  EXPECT_EQ(numbers(twice), (std::vector<int>{1, 2, 3}));
}

TEST(Returns, WhatCannotBeMendedIsFlaggedAndKept) {
  const float no_range = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::vector<Row>> faults{
      {{1, 1, 2, 500}, {1, 1, 2, 500}}, {{1, 1, 2, 500}, {1, 1, 2, no_range}}, {{1, 1, 2, 500}, {1, 1, 2, 0}}};
  for (const auto& rows : faults) {
    core::Block b = block_of(rows);
    EXPECT_EQ(repair_returns(b, {}).inconsistent, 2u);
    EXPECT_EQ(numbers(b), (std::vector<int>{1, 1}));
    EXPECT_EQ(b.flags[0], core::flag::returns_inconsistent);
  }
  core::Block stuck_clock = block_of(std::vector<Row>(16, {1, 1, 1, 500}));
  EXPECT_EQ(repair_returns(stuck_clock, {}).inconsistent, 16u);
  core::Block timeless = block_of({{1, 3, 2, 500}, {1, 1, 2, 500}});
  timeless.time.clear();
  EXPECT_EQ(repair_returns(timeless, {}).inconsistent, 1u);
}

TEST(Returns, GapsAreKeptOnWish) {
  core::Block b = block_of({{1, 1, 3, 480}, {1, 3, 3, 500}});
  EXPECT_EQ(repair_returns(b, {.gaps = Gaps::keep}).inconsistent, 2u);
  EXPECT_EQ(numbers(b), (std::vector<int>{1, 3}));
}

TEST(Returns, MissingColumnsAreMade) {
  core::Block b = block_of({{1, 0, 0, 480}, {1, 0, 0, 500}, {2, 0, 0, 500}});
  b.return_number.clear();
  b.return_count.clear();
  EXPECT_EQ(repair_returns(b, {}).repaired, 3u);
  EXPECT_EQ(numbers(b), (std::vector<int>{1, 2, 1}));
}

TEST(Returns, StatisticsOfBatchesAddUp) {
  core::Block b = block_of({{1, 1, 1, 500}, {2, 1, 3, 480}, {2, 2, 3, 490}, {2, 3, 3, 500}, {3, 1, 1, 500}});
  b.strip[4] = 4;
  std::map<std::uint16_t, StripReturns> whole, parts;
  count_returns(b, whole);
  for (const auto& rows : std::vector<std::vector<std::uint32_t>>{{0}, {1, 2, 3, 4}}) count_returns(core::select(b, rows), parts);
  for (const auto& lines : {whole, parts}) {
    const StripReturns& r = lines.at(3);
    EXPECT_EQ(r.pulses[1], 1u);
    EXPECT_EQ(r.pulses[3], 1u);
    EXPECT_EQ(r.first, 2u);
    EXPECT_EQ(r.last, 2u);
    EXPECT_EQ(r.intermediate, 1u);
    EXPECT_EQ(r.only, 1u);
    EXPECT_EQ(lines.at(4).only, 1u);
  }
}

TEST(Returns, PenetrationIsGroundPulsesOverPulses) {
  core::Block b = block_of({{1, 1, 2, 0}, {1, 2, 2, 0}, {2, 1, 1, 0}, {3, 1, 1, 0}, {4, 1, 1, 0}});
  b.origin = {1000, 2000, 0};
  b.x = {1, 2, 3, 4, 15};
  b.y = {1, 1, 1, 1, 1};
  b.classification = {2, 2, 1, 7, 1};  // a first return never counts, noise neither
  const core::Lattice l{10.0, 100, 200, 3, 1};
  const Penetration p = penetration(b, b.size(), l);
  EXPECT_EQ(p.pulses, (std::vector<std::uint32_t>{2, 1, 0}));
  EXPECT_EQ(p.returns, (std::vector<std::uint32_t>{3, 1, 0}));
  EXPECT_DOUBLE_EQ(p.rate(0), 0.5);
  EXPECT_DOUBLE_EQ(p.rate(1), 0.0);
  EXPECT_TRUE(std::isnan(p.rate(2)));
}

TEST(Returns, OptionsAreDeclared) {
  ReturnsOptions o;
  std::vector<core::Fault> faults;
  core::Value table = core::Value::object();
  table["gaps"] = "keep";
  core::read_options(core::described(o), table, "", faults);
  EXPECT_TRUE(faults.empty());
  EXPECT_EQ(o.gaps, Gaps::keep);
}

}  // namespace
}  // namespace swath::filters
