// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/time.h"

#include <gtest/gtest.h>
#include <rapidjson/document.h>

#include <cmath>
#include <string>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::core {
namespace {

constexpr double resolution = 2.4e-7;  // s, of a double in this century

double unix_at(const std::string& date, double second_of_day) { return unix_of_date(date).value() + second_of_day; }

template <class Action>
std::string refusal(Action action) {
  try {
    action();
  } catch (const Error& e) {
    EXPECT_FALSE(e.hint().empty());
    EXPECT_EQ(e.where(), "a.csv");
    return e.what();
  }
  ADD_FAILURE() << "was not refused";
  return {};
}

TEST(Time, EpochsAndWeeks) {
  EXPECT_EQ(from_unix(unix_at("1980-01-06", 0.0)), 0.0);
  EXPECT_EQ(from_week(1525, 212415.0), 922532415.0);
  EXPECT_EQ(week_of(922532415.0), 1525);
  EXPECT_EQ(seconds_of_week(922532415.0), 212415.0);
  EXPECT_EQ(week_of(-1.0), -1);
  EXPECT_EQ(seconds_of_week(-1.0), seconds_per_week - 1.0);
}

TEST(Time, GpsMinusUtcByDate) {
  // GPS - UTC = 15 s on the day of the flight of 2009-03-31; the steps around every kind of change (IERS Bulletin C).
  EXPECT_EQ(gps_minus_utc_at_unix(unix_at("2009-03-31", 39600.0)), 15);
  EXPECT_EQ(gps_minus_utc_at_unix(unix_at("1979-12-31", 0.0)), 0);
  EXPECT_EQ(gps_minus_utc_at_unix(unix_at("1981-06-30", 86399.0)), 0);
  EXPECT_EQ(gps_minus_utc_at_unix(unix_at("1981-07-01", 0.0)), 1);
  EXPECT_EQ(gps_minus_utc_at_unix(unix_at("2005-12-31", 86399.0)), 13);
  EXPECT_EQ(gps_minus_utc_at_unix(unix_at("2016-12-31", 86399.9)), 17);
  EXPECT_EQ(gps_minus_utc_at_unix(unix_at("2017-01-01", 0.0)), 18);
  EXPECT_EQ(gps_minus_utc_at_unix(unix_at("2024-06-07", 0.0)), 18);
  ASSERT_TRUE(unix_of_date(leap_table_date()).has_value());
  EXPECT_GT(*unix_of_date(leap_table_date()), unix_at("2025-12-31", 0.0));
}

// Every entry of the table: TAI - UTC = 19 + (GPS - UTC) steps by one at these dates and at no other half year (IERS Bulletin C,
// 1980-2017).
TEST(Time, TheTableStepsAtItsDatesOnly) {
  const std::string steps[] = {"1981-07-01", "1982-07-01", "1983-07-01", "1985-07-01", "1988-01-01", "1990-01-01",
                               "1991-01-01", "1992-07-01", "1993-07-01", "1994-07-01", "1996-01-01", "1997-07-01",
                               "1999-01-01", "2006-01-01", "2009-01-01", "2012-07-01", "2015-07-01", "2017-01-01"};
  int expected = 0;
  for (int year = 1980; year <= 2026; ++year)
    for (const char* half : {"-01-01", "-07-01"}) {
      const std::string date = std::to_string(year) + half;
      for (const std::string& s : steps) expected += s == date;
      EXPECT_EQ(gps_minus_utc_at_unix(unix_at(date, 0.0)), expected) << date;
    }
  EXPECT_EQ(expected, 18);
}

TEST(Time, ALeapSecondIsCountedByGpsAndNotByPosix) {
  const GpsTime last = from_unix(unix_at("2016-12-31", 86399.0)), next = from_unix(unix_at("2017-01-01", 0.0));
  EXPECT_EQ(last, 1167264016.0);
  EXPECT_EQ(next - last, 2.0);
  EXPECT_EQ(gps_minus_utc_at_gps(last + 1.5), 17);
  EXPECT_EQ(gps_minus_utc_at_gps(next), 18);
  EXPECT_EQ(to_unix(last), unix_at("2016-12-31", 86399.0));
  EXPECT_EQ(to_unix(last + 1.25), unix_at("2017-01-01", 0.25));
  EXPECT_EQ(to_unix(next), unix_at("2017-01-01", 0.0));
  EXPECT_EQ(utc_text(last), "2016-12-31T23:59:59.000Z");
  EXPECT_EQ(utc_text(last + 1.5), "2016-12-31T23:59:60.500Z");
  EXPECT_EQ(utc_text(next), "2017-01-01T00:00:00.000Z");
}

TEST(Time, UnixComesBackOutsideLeapSeconds) {
  for (double u = unix_at("1980-01-06", 0.125); u < unix_at("2040-01-01", 0.0); u += 1234567.5)
    ASSERT_NEAR(to_unix(from_unix(u)), u, resolution);
}

TEST(Time, ReferenceTimescales) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p003_timescales.json");
  rapidjson::Document d;
  ASSERT_FALSE(d.Parse(test::read_bytes(file).c_str()).HasParseError());
  ASSERT_GE(d["cases"].Size(), 10u);
  for (const auto& c : d["cases"].GetArray()) {
    const std::string utc = c["utc"].GetString();
    const double of_day = std::stod(utc.substr(11, 2)) * 3600.0 + std::stod(utc.substr(14, 2)) * 60.0 + std::stod(utc.substr(17));
    const double u = unix_at(utc.substr(0, 10), of_day);
    const GpsTime t = from_unix(u);
    EXPECT_EQ(t, c["gps_seconds"].GetDouble()) << utc;
    EXPECT_EQ(gps_minus_utc_at_unix(u), c["leap"].GetInt()) << utc;
    EXPECT_EQ(gps_minus_utc_at_gps(t), c["leap"].GetInt()) << utc;
    EXPECT_EQ(week_of(t), c["gps_week"].GetInt()) << utc;
    EXPECT_EQ(seconds_of_week(t), c["sow"].GetDouble()) << utc;
    EXPECT_EQ(from_week(c["gps_week"].GetInt(), c["sow"].GetDouble()), t) << utc;
    EXPECT_EQ(std::floor(to_unix(t) / 86400.0) + 40587.0, c["mjd"].GetDouble()) << utc;  // MJD of 1970-01-01
    EXPECT_EQ(utc_text(t), utc + ".000Z");
    EXPECT_EQ(TimeReader(TimeScale::utc_day, {}, utc.substr(0, 10), "v")(of_day), t) << utc;
    EXPECT_EQ(TimeReader(TimeScale::unix_utc, {}, "", "v")(u), t) << utc;
    EXPECT_EQ(TimeReader(TimeScale::gps_week, c["gps_week"].GetInt(), "", "v")(c["sow"].GetDouble()), t) << utc;
    EXPECT_EQ(TimeReader(TimeScale::gps_adjusted, {}, "", "v")(t - 1e9), t) << utc;
    EXPECT_EQ(TimeReader(TimeScale::gps, {}, "", "v")(t), t) << utc;
  }
}

// The mark of the first exposure of the reference flight: week 1525, 213035.0168671 s = 2009-03-31 11:10:20.017 UTC.
TEST(Time, SecondsOfWeekAndUtcSecondsMeet) {
  TimeReader week(TimeScale::gps_week, 1525, "", "v"), day(TimeScale::utc_day, {}, "2009-03-31", "v");
  const GpsTime t = week(213035.0168671);
  EXPECT_NEAR(t, day(213035.0168671 - 2 * 86400.0 - 15.0), resolution);
  EXPECT_EQ(utc_text(t), "2009-03-31T11:10:20.017Z");
}

TEST(Time, WeekRollOverInsideAFile) {
  TimeReader r(TimeScale::gps_week, 2317, "", "v");
  const double start = 2317 * seconds_per_week;
  EXPECT_EQ(r(604799.5), start + 604799.5);
  EXPECT_EQ(r(0.5), start + 604800.5);
  EXPECT_EQ(r(604799.75), start + 604799.75);  // a late record of before
  EXPECT_EQ(r(1.0), start + 604801.0);
  EXPECT_EQ(r(604799.0), start + 604799.0);
  TimeReader on(TimeScale::gps_week, 2317, "", "v");  // a file that counts on
  EXPECT_EQ(on(604799.5), start + 604799.5);
  EXPECT_EQ(on(604800.5), start + 604800.5);
  TimeReader gap(TimeScale::gps_week, 2317, "", "v");  // a long gap before any roll-over goes forward
  gap(1000.0);
  EXPECT_EQ(gap(500000.0), start + 500000.0);
}

TEST(Time, MidnightInsideAFile) {
  TimeReader r(TimeScale::utc_day, {}, "2009-03-31", "v");
  const GpsTime before = r(86399.5);
  EXPECT_EQ(r(0.25) - before, 0.75);
  EXPECT_EQ(r(43000.0) - before, 43000.5);
  // Over the leap second of 2016: the day has 86401 seconds.
  TimeReader leap(TimeScale::utc_day, {}, "2016-12-31", "v");
  const GpsTime last = leap(86399.0);
  EXPECT_EQ(leap(86400.5) - last, 1.5);
  EXPECT_EQ(leap(0.0) - last, 2.0);
  EXPECT_EQ(leap(0.0), 1167264018.0);
}

TEST(Time, RefusesTimesThatCannotBeRead) {
  const auto made = [](TimeScale s, std::optional<int> week, const char* date) { TimeReader(s, week, date, "a.csv"); };
  EXPECT_NE(refusal([&] { made(TimeScale::unstated, 2317, "2024-06-07"); }).find("not stated"), std::string::npos);
  EXPECT_NE(refusal([&] { made(TimeScale::gps_week, {}, ""); }).find("without their week"), std::string::npos);
  EXPECT_NE(refusal([&] { made(TimeScale::gps_week, -3, ""); }).find("before 1980"), std::string::npos);
  EXPECT_NE(refusal([&] { made(TimeScale::utc_day, {}, ""); }).find("without their date"), std::string::npos);
  EXPECT_NE(refusal([&] { made(TimeScale::utc_day, {}, "2023-02-29"); }).find("no date"), std::string::npos);
  TimeReader week(TimeScale::gps_week, 2317, "", "a.csv"), day(TimeScale::utc_day, {}, "2024-06-07", "a.csv");
  EXPECT_NE(refusal([&] { week(1.4e9); }).find("no second of a week"), std::string::npos);
  EXPECT_NE(refusal([&] { week(-0.5); }).find("no second of a week"), std::string::npos);
  EXPECT_NE(refusal([&] { day(212415.0); }).find("no second of a day"), std::string::npos);
  EXPECT_NE(refusal([&] { day(std::nan("")); }).find("not a number"), std::string::npos);
  EXPECT_NO_THROW(week(604799.0));
  EXPECT_NE(refusal([&] { week.in_week(2317, 474006000.0); }).find("no second of a week"), std::string::npos) << "milliseconds";
  TimeNumbers milliseconds;
  milliseconds.unit = 0.001;
  EXPECT_EQ(TimeReader(TimeScale::gps_week, 0, "", "a.csv", milliseconds).in_week(2317, 474006000.0), from_week(2317, 474006.0));
}

TEST(Time, Dates) {
  EXPECT_EQ(unix_of_date("1970-01-01"), 0.0);
  EXPECT_EQ(unix_of_date("2009-03-31"), 1238457600.0);
  EXPECT_EQ(unix_of_date("2024-02-29"), 1709164800.0);
  for (const char* bad : {"", "2024-2-9", "2024-13-01", "2024-00-10", "2024-04-31", "2024/04/30", "2024-04-3x", "2024-+4-30", "20240430  "})
    EXPECT_FALSE(unix_of_date(bad).has_value()) << bad;
}

TEST(Time, UtcText) {
  EXPECT_EQ(utc_text(0.0), "1980-01-06T00:00:00.000Z");
  EXPECT_EQ(utc_text(-0.5), "1980-01-05T23:59:59.500Z");
  EXPECT_EQ(utc_text(from_unix(unix_at("2024-06-07", 42006.0)) + 0.0024), "2024-06-07T11:40:06.002Z");
  EXPECT_EQ(utc_text(from_unix(unix_at("2024-06-07", 86399.0)) + 0.9996), "2024-06-08T00:00:00.000Z");
  EXPECT_EQ(utc_text(std::nan("")), "no time");
}

TEST(Time, CivilInstants) {
  EXPECT_EQ(gps_of_civil("1980-01-06T00:00:00 GPS"), 0.0);
  EXPECT_EQ(gps_of_civil("2025-07-08T19:34:18.5 GPS"), from_week(2374, 243258.5));
  EXPECT_EQ(gps_of_civil("2025-07-08 19:34:00.5 UTC"), from_week(2374, 243258.5));
  EXPECT_EQ(gps_of_civil("2025-07-08T19:34:00.5Z"), from_week(2374, 243258.5));
  EXPECT_EQ(*gps_of_civil("2016-12-31T23:59:60.5Z") + 0.5, *gps_of_civil("2017-01-01T00:00:00Z"));
  EXPECT_EQ(gps_of_gps_date("2025-07-08", 70458.5), from_week(2374, 243258.5));
  for (const char* wrong : {"", "2025-07-08", "2025-07-08T19:34:18.5", "2025-07-08T19:34:18.5 TAI", "2025-13-08T19:34:18 GPS",
                            "2025-07-08T24:34:18 GPS", "2025-07-08T19:60:18 GPS", "2025-07-08T19:34:60 GPS", "2025-07-08T-9:34:18 GPS",
                            "2025-07-08T19:34:1.8.5 GPS", "2025/07/08T19:34:18 GPS", "2025-07-08T19:34: GPS"})
    EXPECT_FALSE(gps_of_civil(wrong)) << wrong;
  // utc_text() and back.
  EXPECT_EQ(gps_of_civil(utc_text(1.4e9)), 1.4e9);
}

TEST(Time, UnitOffsetAndADevicesZero) {
  TimeNumbers ms{0.001, -0.125, "2025-07-08T19:34:21.985 GPS", 261906};
  TimeReader device(TimeScale::device, {}, "", "a.csv", ms);
  EXPECT_NEAR(device(261906), from_week(2374, 243261.985 - 0.125), resolution);
  EXPECT_NEAR(device(262906), from_week(2374, 243262.985 - 0.125), resolution);
  ms.origin_at = 0;
  EXPECT_NEAR(TimeReader(TimeScale::device, {}, "", "a.csv", ms)(1000), from_week(2374, 243262.985 - 0.125), resolution);
  // Unit and offset act on every scale, and the roll-over is that of the scaled numbers.
  TimeReader week(TimeScale::gps_week, 2317, "", "a.csv", {0.001, 2.0, "", 0});
  EXPECT_EQ(week(604799000), from_week(2317, 604801));
  EXPECT_EQ(week(1000), from_week(2318, 3));
  EXPECT_EQ(TimeReader(TimeScale::unix_utc, {}, "", "a.csv", {1, 0.5, "", 0})(1.7e9), from_unix(1.7e9) + 0.5);
  EXPECT_EQ(week.in_week(2000, 5000), from_week(2000, 7));
  EXPECT_NE(refusal([] { TimeReader(TimeScale::device, {}, "", "a.csv"); }).find("not stated"), std::string::npos);
  EXPECT_NE(refusal([] { TimeReader(TimeScale::device, {}, "", "a.csv", {1, 0, "yesterday", 0}); }).find("no instant"), std::string::npos);
}

// A damaged file may state any number as a time: none may leave the calendar's integers.
TEST(Time, NumbersThatAreNoDateStayNumbers) {
  EXPECT_EQ(utc_text(1e300), "1e+300 s GPS");
  EXPECT_EQ(utc_text(-1e17), "-1e+17 s GPS");
  EXPECT_EQ(week_of(1e300), std::numeric_limits<int>::max());
  EXPECT_EQ(week_of(-1e300), -std::numeric_limits<int>::max());
}

}  // namespace
}  // namespace swath::core
