// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/las_time.h"

#include <cmath>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

using core::TimeScale;
using Times = std::vector<double>;

LasHeader header_of(int format, bool adjusted) {
  LasHeader h;
  h.point_format = format;
  h.global_encoding = adjusted ? las_encoding::adjusted_gps_time : std::uint16_t{0};
  return h;
}

Times gps_times(const Times& recorded, const LasHeader& header, const LasTime& time, std::uint64_t first = 0) {
  LasTimesRead read;
  return las_gps_times(recorded, header, time, read, "file.las", first);
}

TEST(LasTime, TheScaleIsTheOneStatedOrTheFiles) {
  EXPECT_EQ(las_time_scale(header_of(6, true), {}), TimeScale::gps_adjusted);
  EXPECT_EQ(las_time_scale(header_of(6, false), {}), TimeScale::unstated);
  EXPECT_EQ(las_time_scale(header_of(6, false), {.week = 2000}), TimeScale::gps_week);
  EXPECT_EQ(las_time_scale(header_of(6, false), {.scale = TimeScale::gps_adjusted}), TimeScale::gps_adjusted);
  EXPECT_EQ(las_time_scale(header_of(6, true), {.scale = TimeScale::gps_week}), TimeScale::unstated);
  EXPECT_EQ(las_time_scale(header_of(0, true), {}), TimeScale::unstated);
}

TEST(LasTime, EveryScaleBecomesGpsTime) {
  const auto first = [](LasTime time, double recorded, bool bit = false) { return gps_times({recorded}, header_of(6, bit), time)[0]; };
  EXPECT_EQ(first({}, 100.0, true), 1e9 + 100.0);
  EXPECT_EQ(first({.scale = TimeScale::gps_adjusted}, 3.0e8), 1.3e9);
  EXPECT_EQ(first({.scale = TimeScale::gps}, 1.3e9), 1.3e9);
  EXPECT_EQ(first({.week = 2000}, 5.0), 2000 * core::seconds_per_week + 5.0);
  EXPECT_EQ(first({.scale = TimeScale::unix_utc}, 1.6e9), core::from_unix(1.6e9));
  EXPECT_EQ(first({.scale = TimeScale::utc_day, .date = "2020-09-13"}, 3600.0),
            core::from_unix(*core::unix_of_date("2020-09-13") + 3600.0));
  EXPECT_EQ(first({.keep_unknown = true}, 306234562.25), 306234562.25);
}

TEST(LasTime, PeriodsThatBeginAnewAreFollowedInAnyOrder) {
  const Times week = gps_times({604790.0, 5.0, 604799.0}, header_of(6, false), {.week = 2000});
  EXPECT_EQ(week, (Times{2000 * 604800.0 + 604790.0, 2001 * 604800.0 + 5.0, 2000 * 604800.0 + 604799.0}));
  const Times day = gps_times({86390.0, 5.0}, header_of(6, false), {.scale = TimeScale::utc_day, .date = "2020-09-13"});
  EXPECT_EQ(day[1] - day[0], 15.0);
}

TEST(LasTime, WhatAScaleCannotHoldIsNamed) {
  EXPECT_THROW(gps_times({1.0}, header_of(6, false), {}), core::Error);
  EXPECT_THROW(gps_times({1.0}, header_of(6, false), {.scale = TimeScale::utc_day}), core::Error);
  try {
    gps_times({10.0, 306234562.0}, header_of(6, false), {.week = 2000}, 70);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.text().find("file.las: point 71"), std::string::npos) << e.text();
    EXPECT_NE(e.text().find("points.time_scale"), std::string::npos) << e.text();
  }
}

TEST(LasTime, ADamagedFirstTimeMovesNoOther) {
  const auto second = [](LasTime time, double damaged, double recorded) {
    Times t(40, recorded);
    t[0] = damaged;
    const Times out = gps_times(t, header_of(6, false), time);
    EXPECT_TRUE(std::isnan(out[0]));
    return out[1];
  };
  for (const double damaged : {1e18, -5e9, std::nan("")}) {
    EXPECT_EQ(second({.week = 2000}, damaged, 5.0), 2000 * core::seconds_per_week + 5.0);
    EXPECT_EQ(second({.week = 2000}, damaged, 604790.0), 2000 * core::seconds_per_week + 604790.0);
    EXPECT_EQ(second({.scale = TimeScale::utc_day, .date = "2020-09-13"}, damaged, 3600.0),
              core::from_unix(*core::unix_of_date("2020-09-13") + 3600.0));
  }
}

TEST(LasTime, FewAreCountedOverTheWholeFile) {
  LasTimesRead read;
  read.points = 1000;
  const auto next = [&](std::uint64_t first) {
    return las_gps_times({1e18, 5.0}, header_of(6, false), {.week = 2000}, read, "file.las", first);
  };
  for (std::uint64_t i = 0; i < 30; ++i) EXPECT_TRUE(std::isnan(next(2 * i)[0])) << i;
  try {
    next(60);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_EQ(e.where(), "file.las: point 0");
  }
}

TEST(LasTime, AContradictionWithTheBitIsFound) {
  LasTimeCheck adjusted, weekly, none;
  adjusted.add({306234562.5, 306234999.0});
  weekly.add({100.0, 200.0});
  weekly.add({604000.0});
  none.add({0.0, 0.0});
  EXPECT_NE(adjusted.fault(header_of(8, false), TimeScale::unstated).find("306234562.500 to 306234999.000 s"), std::string::npos);
  EXPECT_EQ(adjusted.fault(header_of(8, true), TimeScale::unstated), "");
  EXPECT_EQ(adjusted.fault(header_of(8, false), TimeScale::gps_adjusted), "");
  EXPECT_NE(weekly.fault(header_of(8, true), TimeScale::unstated), "");
  EXPECT_EQ(weekly.fault(header_of(8, false), TimeScale::unstated), "");
  EXPECT_EQ(none.fault(header_of(8, true), TimeScale::unstated), "");
}

}  // namespace
}  // namespace swath::io
