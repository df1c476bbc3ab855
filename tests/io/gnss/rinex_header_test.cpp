// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/rinex_header.h"

#include "core/error.h"
#include "core/time.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

// Epochs are stated to 0.1 us; GPS seconds of this century resolve 0.24 us.
constexpr double time_resolution = 5e-7;
// Receivers of that make let their clock run and set it by whole milliseconds.
constexpr double clock_step = 1.5e-3;
constexpr double clock_drift = 1e-2;  // after an hour of such steps

std::string header_line(std::string text, const std::string& label) {
  text.resize(60, ' ');
  return text + label + "\n";
}

std::string header_2(const std::string& more = {}) {
  return header_line("     2.11           OBSERVATION DATA    G (GPS)", "RINEX VERSION / TYPE") + header_line("ROVER ONE", "MARKER NAME") +
         header_line("12345               TRM41249.00     NONE", "ANT # / TYPE") +
         header_line("  4027893.8000   306998.2000  4919498.9000", "APPROX POSITION XYZ") +
         header_line("        1.5320        0.0100       -0.0200", "ANTENNA: DELTA H/E/N") + more +
         header_line("     6    L1    L2    C1    P1    P2    S1", "# / TYPES OF OBSERV") + header_line("", "END OF HEADER");
}

/// Epoch of version 2 with `n` satellites and 6 types: 2 lines each.
std::string epoch_2(const std::string& time, int n) {
  char text[64];
  std::snprintf(text, sizeof text, " %s  0%3d", time.c_str(), n);
  std::string out = text;
  for (int i = 0; i < n; ++i) {
    if (i > 0 && i % 12 == 0) out += "\n" + std::string(32, ' ');
    char name[16];
    std::snprintf(name, sizeof name, "G%2d", i + 1);
    out += name;
  }
  out += "\n";
  for (int i = 0; i < n; ++i) out += "  20000000.123    20000000.124    20000000.125\n\n";
  return out;
}

std::string header_3(const std::string& system, const std::string& more = {}) {
  return header_line("     3.04           OBSERVATION DATA    " + system, "RINEX VERSION / TYPE") + header_line("ABCD", "MARKER NAME") +
         header_line("", "ANT # / TYPE") + more + header_line("", "END OF HEADER");
}

class RinexFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    test::write_bytes(folder_ / "a.obs", text);
    return folder_ / "a.obs";
  }
  std::string fault(const std::string& text) {
    try {
      scan_rinex(write(text));
    } catch (const core::Error& e) {
      return e.text();
    }
    return "none";
  }
  test::TemporaryFolder folder_;
};

TEST_F(RinexFile, HeaderOfVersion2) {
  const RinexHeader h = scan_rinex(write(header_2(header_line("     0.200", "INTERVAL")) + epoch_2("15  3  1 11  0  0.0000000", 2))).header;
  EXPECT_EQ(h.version, 2.11);
  EXPECT_EQ(h.system, 'G');
  EXPECT_EQ(h.marker, "ROVER ONE");
  EXPECT_EQ(h.antenna_type, "TRM41249.00     NONE");
  ASSERT_TRUE(h.position);
  EXPECT_EQ(*h.position, Eigen::Vector3d(4027893.8, 306998.2, 4919498.9));
  EXPECT_EQ(h.antenna_offset, Eigen::Vector3d(0.01, -0.02, 1.532)) << "east, north, up from height, east, north";
  EXPECT_EQ(h.interval, 0.2);
}

TEST_F(RinexFile, APositionOffTheEarthIsNone) {
  for (const char* p : {"        0.0000        0.0000        0.0000", "       12.0000       -4.0000       20.0000"})
    EXPECT_FALSE(
        scan_rinex(write(header_3("M", header_line(p, "APPROX POSITION XYZ")) + "> 2015 07 01 00 00 30.0000000  0  0\n")).header.position);
}

TEST_F(RinexFile, EpochsOfVersion2) {
  // 14 satellites take a second line of names; an event with a header record of its own and one with new types lie between.
  const std::string text = header_2() + epoch_2("15  3  1 10 59 59.8000000", 14) + epoch_2("15  3  1 11  0  0.0000000", 3) +
                           "                            4  1\n" + header_line("a remark", "COMMENT") +
                           epoch_2("15  3  1 11  0  0.2000000", 12) + epoch_2("15  3  1 11  0  1.4000000", 13);
  const RinexObservations o = scan_rinex(write(text));
  const double first = core::from_week(1834, 10 * 3600 + 59 * 60 + 59.8);  // 2015-03-01 is a Sunday
  EXPECT_EQ(o.epochs, 4u);
  EXPECT_NEAR(o.first, first, time_resolution);
  EXPECT_NEAR(o.last, first + 1.6, time_resolution);
  EXPECT_NEAR(o.interval, 0.2, 1e-12);
  EXPECT_NEAR(o.longest_gap, 1.2, time_resolution);
}

TEST_F(RinexFile, TypesOfObservationsMayChange) {
  std::string text = header_2() + epoch_2("15  3  1 11  0  0.0000000", 2) + "                            4  1\n" +
                     header_line("     2    L1    C1", "# / TYPES OF OBSERV");
  text += " 15  3  1 11  0  1.0000000  0  2G 1G 2\n 1.0\n 2.0\n 15  3  1 11  0  2.0000000  0  2G 1G 2\n 1.0\n 2.0\n";
  EXPECT_EQ(scan_rinex(write(text)).epochs, 3u);
}

TEST_F(RinexFile, CarriageReturnsAndACutEndAreRead) {
  std::string text = header_2() + epoch_2("15  3  1 11  0  0.0000000", 2) + epoch_2("15  3  1 11  0  1.0000000", 9);
  text.resize(text.size() - 200);
  std::string crlf;
  for (const char c : text) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(scan_rinex(write(crlf)).epochs, 2u);
}

TEST_F(RinexFile, TimeSystemsBecomeGpsTime) {
  const std::string epoch = "> 2015 07 01 00 00 30.0000000  0  1\nG01  20000000.123\n";
  const double civil = core::from_week(1851, 3 * 86400 + 30.0);  // 2015-07-01 is a Wednesday
  const auto first = [&](const std::string& system, const std::string& name) {
    const std::string line =
        name.empty() ? "" : header_line("  2015     7     1     0     0   30.0000000     " + name, "TIME OF FIRST OBS");
    return scan_rinex(write(header_3(system, line) + epoch)).first;
  };
  EXPECT_NEAR(first("M", ""), civil, time_resolution);
  EXPECT_NEAR(first("M", "GPS"), civil, time_resolution);
  EXPECT_NEAR(first("E", "GAL"), civil, time_resolution);
  EXPECT_NEAR(first("M", "BDT"), civil + 14, time_resolution);
  EXPECT_NEAR(first("C", ""), civil + 14, time_resolution);
  EXPECT_NEAR(first("R", ""), civil + 17, time_resolution) << "17 leap seconds from this day on";
  EXPECT_NE(fault(header_3("M", header_line("  2015     7     1     0     0   30.0000000     XYZ", "TIME OF FIRST OBS"))).find("XYZ"),
            std::string::npos);
}

TEST_F(RinexFile, KindsByTheFirstLine) {
  const auto kind = [&](const std::string& line) { return rinex_kind(write(line)); };
  EXPECT_EQ(kind(header_3("M")), RinexKind::observations);
  EXPECT_EQ(kind(header_line("     2.11           N: GPS NAV DATA", "RINEX VERSION / TYPE")), RinexKind::navigation);
  EXPECT_EQ(kind(header_line("     2.10           G: GLONASS NAV", "RINEX VERSION / TYPE")), RinexKind::navigation);
  EXPECT_EQ(kind(header_line("     3.00           C", "RINEX VERSION / TYPE")), RinexKind::clocks);
  EXPECT_EQ(kind("#cP2015  7  1  0  0  0.00000000      96 ORBIT IGb08 HLM  IGS\n"), RinexKind::orbits);
  EXPECT_EQ(kind("time,x,y\n"), RinexKind::other);
  EXPECT_EQ(kind(""), RinexKind::other);
}

TEST_F(RinexFile, FaultsNameTheirLine) {
  EXPECT_NE(fault("").find("empty"), std::string::npos);
  EXPECT_NE(fault(header_line("1.0                 COMPACT RINEX FORMAT", "CRINEX VERS   / TYPE")).find("crx2rnx"), std::string::npos);
  EXPECT_NE(fault("\x1f\x8b\x08").find("gunzip"), std::string::npos);
  EXPECT_NE(fault(header_line("     2.11           N: GPS NAV DATA", "RINEX VERSION / TYPE")).find("holds navigation data"),
            std::string::npos);
  EXPECT_NE(fault(header_line("     1.00           OBSERVATION DATA    G", "RINEX VERSION / TYPE")).find("version 1.00"),
            std::string::npos);
  EXPECT_NE(fault(header_line("     2.11           OBSERVATION DATA    G", "RINEX VERSION / TYPE")).find("no end"), std::string::npos);
  EXPECT_NE(fault(header_3("M", header_line("  40278x3.8000", "APPROX POSITION XYZ"))).find("a.obs:4: '40278x3.8000' is no number"),
            std::string::npos);
  EXPECT_NE(fault(header_2()).find("no epoch"), std::string::npos);
  EXPECT_NE(fault(header_2() + epoch_2("15 13  1 11  0  0.0000000", 2)).find("a.obs:8: '2015-13-01' is no date"), std::string::npos);
  EXPECT_NE(fault(header_3("M") + "> 2015 07 01 00 99 30.0000000  0  1\n").find("time of day"), std::string::npos);
  EXPECT_THROW(scan_rinex(folder_ / "none.obs"), core::Error);
  EXPECT_THROW(scan_rinex(folder_.path()), core::Error);
}

TEST(Rinex, AnHourOfTwoStations) {
  SWATH_SHARED_OR_SKIP(data, "data/rinex_rtklib");
  const RinexObservations rover = scan_rinex(data / "07590920.05o"), base = scan_rinex(data / "30400920.05o");
  EXPECT_EQ(rover.header.marker, "0759");
  EXPECT_EQ(rover.header.antenna_type, "TRM29659.00");
  ASSERT_TRUE(rover.header.position && base.header.position);
  EXPECT_EQ(*rover.header.position, Eigen::Vector3d(-3976219.5082, 3382372.5671, 3652512.9849));
  for (const RinexObservations& o : {rover, base}) {
    EXPECT_EQ(o.epochs, 120u);
    EXPECT_EQ(o.interval, 30.0);
    EXPECT_NEAR(o.longest_gap, 30.0, clock_step);
    EXPECT_EQ(o.first, core::from_week(1316, 518400.0));
    EXPECT_NEAR(o.last, core::from_week(1316, 521970.0), clock_drift);
  }
  EXPECT_EQ(rinex_kind(data / "07590920.05n"), RinexKind::navigation);
}

TEST_F(RinexFile, AnEpochOfNoSurveyIsRefused) {
  const std::string text = header_3("G") + "> 2020 03 18 10 00  0.0000000  0  0\n> 5520 03 18 10 00  1.0000000  0  0\n";
  EXPECT_NE(fault(text).find("between 1980 and 2100"), std::string::npos) << fault(text);
}

}  // namespace
}  // namespace swath::io
