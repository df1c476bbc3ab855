// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/describe_gnss.h"

#include <cstring>

#include "core/error.h"
#include "io/survey/info.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(DescribeGnss, ASolutionOfRtklib) {
  const test::TemporaryFolder folder;
  std::string text =
      "% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix)\n%  GPST latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m)\n";
  for (int i = 0; i < 20; ++i)
    text += "2374 " + std::to_string(243258 + i + (i > 9 ? 30 : 0)) + " 40.5 -105.25 1600 " + (i < 3 ? "2" : "1") + " 9 0.01 0.01 0.02\n";
  test::write_bytes(folder / "a.txt", text);
  core::Value facts = describe_file(folder / "a.txt");
  EXPECT_EQ(facts.find("format")->as_text(), "RTKLIB solution");
  EXPECT_EQ(facts.find("fixes")->as_int(), 20);
  EXPECT_EQ(facts.find("fixes_by_quality")->find("fixed")->as_int(), 17);
  EXPECT_EQ(facts.find("rate_hz")->as_number(), 1);
  EXPECT_EQ(facts.find("seconds")->as_number(), 49);
  EXPECT_EQ(facts.find("from")->as_text(), "2025-07-08T19:34:00.000Z");
  EXPECT_NEAR(facts.find("median_sigma_height_m")->as_number(), 0.02, 1e-9);
  EXPECT_NE(info_text(facts).find("GNSS gaps: 1 (31 s from"), std::string::npos) << info_text(facts);
  // What cannot be read without a survey is described all the same.
  test::write_bytes(folder / "b.pos", "% (lat/lon/height=WGS84/geodetic)\n" + text.substr(text.find('\n') + 1));
  facts = describe_file(folder / "b.pos");
  EXPECT_EQ(facts.find("heights")->as_text(), "above the geoid");
  EXPECT_NE(info_text(facts).find("warning: the heights are above the geoid"), std::string::npos) << info_text(facts);
}

TEST(DescribeGnss, NmeaWithoutADate) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.log", "$GPGGA,094736,5251.0094,N,00518.8172,E,1,12,0.60,-4,M,46.8,M,,*4B\r\n");
  const core::Value facts = describe_file(folder / "a.log");
  EXPECT_EQ(facts.find("format")->as_text(), "NMEA");
  const core::Value& sentence = facts.find("sentences")->items().at(0);
  EXPECT_EQ(sentence.find("name")->as_text(), "GGA");
  EXPECT_EQ(sentence.find("count")->as_int(), 1);
  EXPECT_NE(info_text(facts).find("no RMC or ZDA sentence states the date"), std::string::npos);
}

TEST(DescribeGnss, TimeTagsOfRtklib) {
  const test::TemporaryFolder folder;
  std::string bytes = "TIMETAG RTKLIB demo5";
  bytes.resize(64, '\0');
  const std::uint32_t second = 1752003261, arrival[4] = {131, 37, 548731, 90};
  const double fraction = 0.854;
  bytes.append(reinterpret_cast<const char*>(&second), 4);  // little-endian, as the machines this runs on
  bytes.append(reinterpret_cast<const char*>(&fraction), 8);
  bytes.append(reinterpret_cast<const char*>(arrival), 16);
  test::write_bytes(folder / "a.csv.tag", bytes);
  const core::Value facts = describe_file(folder / "a.csv.tag");
  EXPECT_EQ(facts.find("recording_began")->as_text(), "2025-07-08T19:34:21.854 GPS");
  EXPECT_EQ(facts.find("gps_week")->as_int(), 2374);
  EXPECT_NEAR(facts.find("first_arrival_s")->as_number(), 0.131, 1e-12);
  EXPECT_NEAR(facts.find("last_arrival_s")->as_number(), 548.731, 1e-12);
  test::write_bytes(folder / "short.tag", bytes.substr(0, 70));
  EXPECT_FALSE(looks_like_tag(folder / "short.tag"));
}

}  // namespace
}  // namespace swath::io
