// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/target_tables.h"

#include <gtest/gtest.h>

#include "tests/calib/report/made_report.h"

namespace swath::calib {
namespace {

const report::Table& table(const std::vector<report::Table>& tables, const std::string& id) {
  for (const report::Table& t : tables)
    if (t.id == id) return t;
  throw std::runtime_error("no table " + id);
}

TEST(TargetTables, TellAnglesReadingsAndLines) {
  const auto tables = target_tables(made_report().flat_target);
  ASSERT_EQ(tables.size(), 3u);
  for (const report::Table& t : tables)
    for (const auto& row : t.rows) EXPECT_EQ(row.size(), t.columns.size()) << t.id;

  const auto& angles = table(tables, "target-angles").rows;
  ASSERT_EQ(angles.size(), 2u);
  EXPECT_EQ(angles[0],
            (std::vector<std::string>{"roll", "0.30000", "0.31549", "9.0", "7.5", "18.0", "2", "beyond the tolerance: new value"}));
  EXPECT_EQ(angles[1].back(), "not determined");
  EXPECT_EQ(angles[1][2], "–");

  const auto& readings = table(tables, "target-readings").rows;
  ASSERT_EQ(readings.size(), 3u);
  EXPECT_EQ(readings[0], (std::vector<std::string>{"roll", "1 and 2", "0.31500", "deg", "12.0", "arcsec"}));
  EXPECT_EQ(readings[2], (std::vector<std::string>{"range offset", "3", "−0.0312", "m", "0.0125", "m"}));

  const auto& lines = table(tables, "target-lines").rows;
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0][1], "nadir");
  EXPECT_EQ(lines[0][6], "0.812");
  EXPECT_EQ(lines[0][9], "0.012");
  EXPECT_EQ(lines[1][1], "–") << "a line that has not seen the target";
  EXPECT_EQ(lines[1][6], "–");
}

TEST(TargetTables, AnalysisWithoutResultGivesNone) {
  core::Value tree = core::Value::object();
  tree["done"] = false;
  EXPECT_TRUE(target_tables(tree).empty());
}

}  // namespace
}  // namespace swath::calib
