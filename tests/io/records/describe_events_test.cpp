// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/describe_events.h"

#include <gtest/gtest.h>

#include "io/survey/info.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(DescribeEvents, EventsClocksAndHangarsByTheirContent) {
  const test::TemporaryFolder folder;
  const auto facts_of = [&](const char* name, const std::string& text) {
    test::write_bytes(folder / name, text);
    return describe_file(folder / name);
  };
  const std::string photos =
      "1\t400373.488877\t[2264]\t-40,N\t0,E\t86,V\t44.4,Lat\t1.2,Lon\t359.4,Ellh\t0.028, 0.031, 0.055\t50,Q\n"
      "2\t400375.988877\t[2264]\t-40,N\t0,E\t86,V\t44.4,Lat\t1.2,Lon\t359.4,Ellh\t0.028, 0.031, 0.055\t50,Q\n";
  const core::Value mrk = facts_of("x_Timestamp.MRK", photos);
  EXPECT_EQ(mrk.find("format")->as_text(), "Timestamp.MRK (DJI)");
  EXPECT_EQ(mrk.find("events")->as_int(), 2);
  EXPECT_NEAR(mrk.find("median_interval_s")->as_number(), 2.5, 1e-6);
  EXPECT_EQ(mrk.find("with_place")->as_int(), 2);
  // Cut off in its second line: named, with the line.
  const core::Value cut = facts_of("y.mrk", photos.substr(0, photos.size() - 40));
  EXPECT_NE(info_text(cut).find("y.mrk:2"), std::string::npos) << info_text(cut);
  const core::Value marks = facts_of("marks.log",
                                     "#MARKTIMEA,COM1,0,77.5,FINESTEERING,1358,422621.000,00000000,292e,2214;1358,422621.000000500,"
                                     "-1.398163614e-08,7.812745577e-08,-14.000000002,VALID*d8502226\n");
  EXPECT_EQ(marks.find("format")->as_text(), "MARKTIME (NovAtel)");
  EXPECT_EQ(marks.find("events")->as_int(), 1);
  const core::Value log =
      facts_of("loopstats.20090331", "54921 39605.0 -0.000900 15.0 0.000020 0.5 4\n54921 39621.0 -0.000850 15.0 0.000030 0.5 4\n");
  EXPECT_EQ(log.find("format")->as_text(), "loopstats");
  EXPECT_EQ(log.find("records")->as_int(), 2);
  EXPECT_NEAR(log.find("offset_s")->items()[0].as_number(), -0.0009, 1e-12);
  EXPECT_NEAR(log.find("jitter_s")->items()[1].as_number(), 0.00003, 1e-12);
  const core::Value hangar =
      facts_of("hangar.toml", "[[target]]\nname = \"T1\"\nat = [\"1 m\", \"2 m\", \"3 m\"]\n[[point]]\nname = \"CP\"\n");
  EXPECT_EQ(hangar.find("format")->as_text(), "hangar survey");
}

TEST(DescribeEvents, EventsOfOneTimeAreNamed) {
  const test::TemporaryFolder folder;
  const std::string rest = "\t[2264]\t-40,N\t0,E\t86,V\t44.4,Lat\t1.2,Lon\t359.4,Ellh\t0.028, 0.031, 0.055\t50,Q\n";
  const std::string photos = "1\t400373.488877" + rest + "2\t400375.988877" + rest;
  test::write_bytes(folder / "a.MRK", photos);
  EXPECT_TRUE(describe_file(folder / "a.MRK").find("warnings")->items().empty());
  test::write_bytes(folder / "b.MRK", photos + "3\t400375.988877" + rest);
  const std::string text = info_text(describe_file(folder / "b.MRK"));
  EXPECT_NE(text.find("warning: events at the time of another one: 1 (2 and 3)"), std::string::npos) << text;
}

TEST(DescribeEvents, FilesOfTheWrongKindSayWhy) {
  const test::TemporaryFolder folder;
  const auto warning_of = [&](const std::string& text, EventFormat format) {
    test::write_bytes(folder / "f", text);
    const core::Value facts = describe_events(folder / "f", format);
    EXPECT_EQ(facts.find("events")->as_int(), 0);
    EXPECT_EQ(facts.find("first"), nullptr);
    return facts.find("warnings")->items().at(0).as_text();
  };
  EXPECT_NE(warning_of("t,id\n1,a\n", EventFormat::ubx).find("holds no message of UBX"), std::string::npos);
  EXPECT_NE(warning_of("t,id\n1,a\n", EventFormat::mrk).find("f:1: is no line of a Timestamp.MRK"), std::string::npos)
      << warning_of("t,id\n1,a\n", EventFormat::mrk);
  EXPECT_NE(warning_of("", EventFormat::novatel).find("holds no line of MARKTIME"), std::string::npos);
  EXPECT_NE(warning_of("", EventFormat::rinex).find("the file is empty"), std::string::npos);
}

TEST(DescribeEvents, ALogThatIsNotOfAClockIsNotTakenForOne) {
  const test::TemporaryFolder folder;
  const auto looks = [&](const std::string& text) {
    test::write_bytes(folder / "log", text);
    return looks_like_loopstats(folder / "log");
  };
  EXPECT_TRUE(looks("54921 39605.0 -0.0009 15.0 0.00002 0.5 4\n"));
  EXPECT_FALSE(looks("54921 39605.0 -0.0009 15.0 0.00002 0.5\n"));      // six fields
  EXPECT_FALSE(looks("329941.3 5.0 10.0 15.0 0.00002 0.5 4\n"));        // an easting is no day
  EXPECT_FALSE(looks("54921 39605.0 -0.0009 15.0 0.00002 0.5 4.5\n"));  // a poll is a whole number
  EXPECT_FALSE(looks(""));
}

TEST(DescribeEvents, AClockLogCutOffAndAHangarThatIsNotReadable) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "loopstats", "54921 39605.0 -0.0009 15.0 0.00002 0.5 4\n54921 x\n");
  EXPECT_NE(info_text(describe_loopstats(folder / "loopstats")).find("loopstats:2"), std::string::npos)
      << info_text(describe_loopstats(folder / "loopstats"));
  test::write_bytes(folder / "hangar.toml", "[[point]]\nname = \"CP\"\ntargets = 3\n");
  const core::Value hangar = describe_hangar(folder / "hangar.toml");
  EXPECT_EQ(hangar.find("points"), nullptr);
  EXPECT_FALSE(hangar.find("warnings")->items().empty());
}

}  // namespace
}  // namespace swath::io
