// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/nmea.h"

#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/time.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// A sentence with its checksum.
std::string sentence(const std::string& text) {
  unsigned sum = 0;
  for (const char c : text) sum ^= static_cast<unsigned char>(c);
  char end[8];
  std::snprintf(end, sizeof end, "*%02X\r\n", sum);
  return "$" + text + end;
}
std::string gga(const std::string& time, int quality = 4, const std::string& separation = "46.8") {
  return sentence("GNGGA," + time + ",4830.0000,N,01115.0000,W," + std::to_string(quality) + ",12,0.9,500.25,M," + separation + ",M,,");
}
std::string rmc(const std::string& time, const std::string& date, const char* status = "A") {
  return sentence("GNRMC," + time + "," + status + ",4830.0000,N,01115.0000,W,0.1,2.0," + date + ",,,A");
}

class Nmea : public ::testing::Test {
 protected:
  core::GnssData read(const std::string& text, const std::string& date = "") {
    test::write_bytes(folder_ / "a.log", text);
    GnssFile f;
    f.time.date = date;
    return read_nmea(folder_ / "a.log", f, 0, tally_);
  }
  std::string refusal(const std::string& text, const std::string& date = "") {
    try {
      read(text, date);
    } catch (const core::Error& e) {
      return e.text();
    }
    return "was read";
  }
  static double utc(const std::string& date, double of_day) { return core::from_unix(*core::unix_of_date(date)) + of_day; }
  test::TemporaryFolder folder_;
  core::Tally tally_;
};

TEST_F(Nmea, PositionsQualitiesAndLeapSeconds) {
  std::string text;
  for (const int q : {1, 2, 3, 4, 5, 9})
    text += gga("10000" + std::to_string(q) + ".50", q) + rmc("10000" + std::to_string(q) + ".50", "180320");
  const core::GnssData g = read(text);
  ASSERT_EQ(g.size(), 6u);
  EXPECT_EQ(g.time[0], utc("2020-03-18", 36001.5));
  EXPECT_EQ(core::utc_text(g.time[0]), "2020-03-18T10:00:01.500Z");
  const core::Geodetic p = core::geodetic_of(g.position[0]);
  EXPECT_NEAR(core::to_degrees(p.latitude), 48.5, 1e-9);
  EXPECT_NEAR(core::to_degrees(p.longitude), -11.25, 1e-9);
  EXPECT_NEAR(p.height, 547.05, 1e-6);
  using core::FixQuality;
  EXPECT_EQ(g.quality, (std::vector<FixQuality>{FixQuality::single, FixQuality::differential, FixQuality::single, FixQuality::fixed,
                                                FixQuality::float_ambiguity, FixQuality::sbas}));
  EXPECT_EQ(g.satellites[0], 12);
  EXPECT_FALSE(g.has_velocity());
  EXPECT_GT(g.covariance[0](0, 0), 100 * g.covariance[3](0, 0));
}

TEST_F(Nmea, OfTwoTalkersAtOneTimeTheFirstCounts) {
  std::string text = rmc("100001.00", "180320");
  for (int k = 1; k <= 5; ++k) {
    const std::string of_gn = gga("10000" + std::to_string(k) + ".00");
    text += of_gn + sentence("GP" + of_gn.substr(3, of_gn.find('*') - 3));
  }
  EXPECT_EQ(read(text).size(), 5u);
}

TEST_F(Nmea, SigmasOfGstBeforeOrBehindThePosition) {
  const std::string date = sentence("GPZDA,100001.00,18,03,2020,00,00");
  const auto gst = [](const std::string& time) { return sentence("GPGST," + time + ",1.0,,,,0.3,0.4,0.5"); };
  const core::GnssData g = read(date + gga("100001.00") + gst("100001.00") + gst("100002.00") + gga("100002.00") + gga("100003.00"));
  const Eigen::Matrix3d R = core::ecef_R_ned(core::degrees(48.5).value, core::degrees(-11.25).value);
  for (const size_t i : {0, 1}) {
    const Eigen::Vector3d sigma = (R.transpose() * g.covariance[i] * R).diagonal().cwiseSqrt();
    EXPECT_NEAR((sigma - Eigen::Vector3d(0.3, 0.4, 0.5)).norm(), 0, 1e-12) << i;
  }
  EXPECT_NEAR((R.transpose() * g.covariance[2] * R)(2, 2), 0.04 * 0.04, 1e-12);
  EXPECT_EQ(tally_.of("GNSS files with fixes without sigmas of their own: those of the survey taken"), 1u);
}

TEST_F(Nmea, MidnightIsFollowedByEverySource) {
  // The date sentence stands before, behind, or nowhere.
  const std::string fixes = gga("235959.00") + gga("000000.00") + gga("000001.00");
  for (const core::GnssData& g :
       {read(rmc("235958.00", "311218") + fixes), read(fixes + rmc("000001.00", "010119")), read(fixes, "2018-12-31")}) {
    ASSERT_EQ(g.size(), 3u);
    for (size_t i = 0; i < 3; ++i) EXPECT_EQ(g.time[i], utc("2018-12-31", 86399 + static_cast<double>(i))) << i;
  }
  // An inserted second.
  const core::GnssData leap = read(rmc("235958.00", "311216") + gga("235959.00") + gga("235960.00") + gga("000000.00"));
  ASSERT_EQ(leap.size(), 3u);
  EXPECT_EQ(leap.time[1] - leap.time[0], 1);
  EXPECT_EQ(leap.time[2] - leap.time[1], 1);
}

TEST_F(Nmea, DatesThatAreWrong) {
  EXPECT_NE(refusal(gga("100000.00")).find("no RMC or ZDA sentence states the date"), std::string::npos);
  EXPECT_NE(refusal(gga("100000.00") + rmc("100000.00", "180320", "V")).find("date = \"YYYY-MM-DD\""), std::string::npos);
  // 1024 weeks early, as receivers after the roll-over of 2019.
  core::GnssData g = read(gga("100000.00") + rmc("100000.00", "020800"), "2020-03-18");
  EXPECT_EQ(g.time[0], utc("2020-03-18", 36000));
  EXPECT_EQ(tally_.of("NMEA files whose GPS week had rolled over: moved to the stated date"), 1u);
  EXPECT_NE(refusal(gga("100000.00") + rmc("100000.00", "180320"), "2020-03-19").find("not of 2020-03-19"), std::string::npos);
  EXPECT_EQ(read(gga("100000.00") + rmc("100000.00", "180320"), "2020-03-18").size(), 1u);
  g = read(gga("100000.00") + rmc("100000.00", "220899"));
  EXPECT_EQ(g.time[0], utc("1999-08-22", 36000));
  EXPECT_EQ(tally_.of("files dated before 2000: a GPS week number that rolled over at 1024?"), 1u);
}

TEST_F(Nmea, WhatIsLeftOut) {
  std::string wrong = gga("100003.00");
  wrong[20] = '7';
  std::string junk = "\x01\x02\xff";
  junk += '\0';
  const std::string text = "# a comment\n" + rmc("100000.00", "180320") + gga("100000.00") + gga("100001.00", 0) + gga("100001.00", 6) +
                           gga("100002.00", 4, "") + wrong + junk + "\n" + junk + gga("100004.00") + "$GPGGA,100005.00,48\n" + "text\n" +
                           gga("100004.00") + gga("100005.00") + gga("100006.00") + gga("100007.00");
  const core::GnssData g = read(text);
  EXPECT_EQ(g.size(), 5u);
  EXPECT_EQ(tally_.of("NMEA positions without a solution, left out"), 1u);
  EXPECT_EQ(tally_.of("NMEA positions estimated, entered by hand or simulated, left out"), 1u);
  EXPECT_EQ(tally_.of("NMEA positions without a geoid separation, left out"), 1u);
  EXPECT_EQ(tally_.of("NMEA sentences whose checksum is wrong or missing, left out"), 2u);
  EXPECT_EQ(tally_.of("NMEA lines without a sentence, left out"), 2u);
  EXPECT_NE(refusal("nothing here\n").find("is it a NMEA log?"), std::string::npos);
  EXPECT_NE(refusal(gga("100001.00", 0)).find("had no solution"), std::string::npos);
}

TEST_F(Nmea, EveryTruncationIsReadOrRefused) {
  const std::string text =
      rmc("100000.00", "180320") + gga("100000.00") + sentence("GPGST,100000.00,1.0,,,,0.3,0.4,0.5") + gga("100001.00");
  for (size_t n = 0; n <= text.size(); ++n) {
    try {
      const core::GnssData g = read(text.substr(0, n));
      EXPECT_GT(n, rmc("100000.00", "180320").size());
      EXPECT_EQ(core::utc_text(g.time[0]), "2020-03-18T10:00:00.000Z");
    } catch (const core::Error& e) {
      EXPECT_LT(n, text.size()) << e.text();
    }
  }
}

TEST_F(Nmea, IsKnownByItsContent) {
  test::write_bytes(folder_ / "a", std::string("\x01\x02", 2) + gga("100000.00"));
  EXPECT_TRUE(looks_like_nmea(folder_ / "a"));
  test::write_bytes(folder_ / "b", "$GPGGA,1,2*00\n$ 5,3\n");
  EXPECT_FALSE(looks_like_nmea(folder_ / "b"));
}

TEST(NmeaReference, ReceiversOfAllKinds) {
  SWATH_SHARED_OR_SKIP(folder, "data/gpsd_nmea");
  struct Log {
    const char *name, *first, *last;
    size_t fixes;
    double latitude, longitude;
  };
  for (const Log& log : {Log{"bundg_zeus_9.log", "2018-08-20T09:47:36.000Z", "2018-08-20T09:49:59.000Z", 138, 52.85, 5.31},
                         {"hemi.log", "2018-09-07T19:40:50.000Z", "2018-09-07T19:41:00.000Z", 21, 42.36, -71.03},
                         {"mt3339.log", "2015-04-13T20:26:40.000Z", "2015-04-13T20:27:09.000Z", 30, 44.07, -121.31},
                         {"nmea-rtk.log", "2020-03-18T13:28:19.600Z", "2020-03-18T13:39:01.500Z", 122, 41.57, -93.75},
                         {"quectel-l76k-nmea.log", "2026-08-05T05:52:34.200Z", "2026-08-05T05:53:04.000Z", 150, 47.66, -122.33},
                         {"skytraq-dgps.log", "2016-04-07T21:31:21.000Z", "2016-04-07T21:32:56.000Z", 96, 44.07, -121.31},
                         {"ublox-8.log", "2017-01-10T00:09:41.000Z", "2017-01-10T00:10:52.000Z", 72, 44.07, -121.31},
                         {"ublox-neo-m9n-nmea.log", "2020-07-11T22:37:45.000Z", "2020-07-11T22:38:45.000Z", 61, 38.11, -122.63},
                         {"ublox-zed-f9p-nmea.log", "2019-04-12T00:39:56.000Z", "2019-04-12T00:40:24.000Z", 29, -45.88, 170.5}}) {
    core::Tally tally;
    ASSERT_TRUE(looks_like_nmea(folder / log.name)) << log.name;
    const core::GnssData g = read_nmea(folder / log.name, {}, 0, tally);
    EXPECT_EQ(g.size(), log.fixes) << log.name;
    EXPECT_EQ(core::utc_text(g.time.front()), log.first) << log.name;
    EXPECT_EQ(core::utc_text(g.time.back()), log.last) << log.name;
    const core::Geodetic p = core::geodetic_of(g.position[0]);
    EXPECT_NEAR(core::to_degrees(p.latitude), log.latitude, 0.01) << log.name;
    EXPECT_NEAR(core::to_degrees(p.longitude), log.longitude, 0.01) << log.name;
    EXPECT_EQ(tally.of("NMEA sentences whose checksum is wrong or missing, left out"), std::string(log.name) == "ublox-8.log" ? 1u : 0u);
  }
  core::Tally tally;
  EXPECT_FALSE(looks_like_nmea(folder / "ublox-8-time.log"));
  EXPECT_THROW(read_nmea(folder / "ublox-8-time.log", {}, 0, tally), core::Error);
  EXPECT_EQ(read_nmea(folder / "nmea-rtk.log", {}, 0, tally).quality.back(), core::FixQuality::fixed);
}

}  // namespace
}  // namespace swath::io
