// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/wild_records.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace swath::io {
namespace {

std::vector<double> series(size_t n, double first = 1000.0, double step = 0.01) {
  std::vector<double> out;
  for (size_t i = 0; i < n; ++i) out.push_back(first + step * static_cast<double>(i));
  return out;
}

TEST(WildRecords, FewAreThreePerCentOrThreeOfTen) {
  EXPECT_TRUE(are_few(30, 1000));
  EXPECT_FALSE(are_few(31, 1000));
  EXPECT_TRUE(are_few(3, 10));
  EXPECT_FALSE(are_few(4, 10));
  EXPECT_FALSE(are_few(1, 9));
  EXPECT_TRUE(are_few(0, 0));
}

TEST(WildRecords, OneTimeFarFromTheOthersIsFoundWhereverItStands) {
  for (const size_t at : {0, 1, 50, 98, 99})
    for (const double wild : {1e9, -5.0, 5000.0}) {
      std::vector<double> t = series(100);
      t[at] = wild;
      const std::vector<size_t> found = wild_times(t);
      EXPECT_EQ(found, wild == -5.0 ? std::vector<size_t>{} : std::vector<size_t>{at}) << at << ' ' << wild;
      t[at] = -1e6;
      EXPECT_EQ(wild_times(t), std::vector<size_t>{at});
    }
}

TEST(WildRecords, NeitherGapsNorTheWeeksEndAreWild) {
  std::vector<double> t = series(50);
  for (const double later : series(50, 90000.0)) t.push_back(later);
  EXPECT_TRUE(wild_times(t).empty());
  std::vector<double> week = series(3, 604799.97);
  for (const double next : series(100, 0.0)) week.push_back(next);
  EXPECT_TRUE(wild_times(week, core::seconds_per_week).empty());
}

TEST(WildRecords, ImpossibleTimesBecomeNaNAndAreCounted) {
  TimeTags tags;
  tags.scale = core::TimeScale::gps_week;
  tags.week = 2317;
  std::vector<double> t = series(200, 474000.0);
  t[5] = std::nan("");
  t[50] = 1e9;
  t[100] = -5.0;
  t[199] = 600000.0;
  core::Tally tally;
  const std::vector<double> gps = gps_times(tags, "a.csv", t, {}, "left out", tally);
  for (size_t i = 0; i < t.size(); ++i) EXPECT_EQ(std::isnan(gps[i]), i == 5 || i == 50 || i == 100 || i == 199) << i;
  EXPECT_DOUBLE_EQ(gps[0], 2317 * core::seconds_per_week + 474000.0);
  EXPECT_EQ(tally.of("left out"), 4u);
  EXPECT_NE(tally.value().find("left out")->find("examples")->items()[1].as_text().find("record 50: time 1e+09"), std::string::npos);
}

TEST(WildRecords, AFirstTimeThatIsWildDoesNotTurnTheWeek) {
  TimeTags tags;
  tags.scale = core::TimeScale::gps_week;
  tags.week = 2317;
  std::vector<double> t = series(100, 1000.0);
  t[0] = 600000.0;
  core::Tally tally;
  EXPECT_DOUBLE_EQ(gps_times(tags, "a.csv", t, {}, "left out", tally)[1], 2317 * core::seconds_per_week + t[1]);
}

TEST(WildRecords, AFileOfAnotherScaleIsRefused) {
  TimeTags tags;
  tags.scale = core::TimeScale::gps_week;
  tags.week = 2317;
  core::Tally tally;
  try {
    gps_times(tags, "a.csv", series(100, 1.4e9), {}, "left out", tally);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("no second of a week"), std::string::npos);
    EXPECT_EQ(e.where(), "a.csv: record 0");
  }
}

}  // namespace
}  // namespace swath::io
