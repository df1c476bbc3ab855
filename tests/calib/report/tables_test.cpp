// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/tables.h"

#include <gtest/gtest.h>

#include <sstream>

#include "core/config/units.h"
#include "tests/calib/report/made_report.h"

namespace swath::calib {
namespace {

std::vector<std::vector<std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> out;
  std::istringstream in(csv);
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> row(1);
    bool quoted = false;
    for (const char c : line)
      if (c == '"')
        quoted = !quoted;
      else if (c == ',' && !quoted)
        row.emplace_back();
      else
        row.back() += c;
    out.push_back(std::move(row));
  }
  return out;
}

TEST(CalibrationTables, EveryRowHasTheHeadersColumns) {
  const CalibrationReport r = made_report();
  size_t knots = 0, points = 0;
  for (const auto& c : r.adjustment.corrections) knots += c.time.size();
  for (const auto& s : r.sections)
    for (const auto* side : {&s.before, &s.after})
      for (const auto& line : *side) points += line.along.size();
  const std::vector<std::pair<std::string, size_t>> files{{residuals_csv(r), r.adjustment.groups.size()},
                                                          {corrections_csv(r), knots},
                                                          {planes_csv(r), r.ties.planes.size()},
                                                          {sections_csv(r), points}};
  for (const auto& [text, n] : files) {
    const auto rows = rows_of(text);
    ASSERT_EQ(rows.size(), n + 1) << rows[0][0];
    for (const auto& row : rows) ASSERT_EQ(row.size(), rows[0].size()) << row[0];
  }
  EXPECT_EQ(rows_of(planes_csv(r))[2][2], "apron, south");
}

TEST(CalibrationTables, NumbersReadBackTheSame) {
  const CalibrationReport r = made_report();
  const auto rows = rows_of(residuals_csv(r));
  const calib::GroupResidual& g = r.adjustment.groups[17];
  EXPECT_EQ(std::stod(rows[18][6]), g.range);
  EXPECT_EQ(std::stod(rows[18][8]), g.after);
  EXPECT_EQ(std::stoi(rows[18][2]), r.ties.lines[g.line].id);
  CalibrationReport unknown = made_report();
  unknown.adjustment.groups[0].before = calib::not_known;
  EXPECT_EQ(rows_of(residuals_csv(unknown))[1][7], "");
}

}  // namespace
}  // namespace swath::calib
