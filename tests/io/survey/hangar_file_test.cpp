// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/hangar_file.h"

#include <cmath>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

constexpr double rounding = 1e-12;

constexpr const char* head =
    "name = \"made\"\n"
    "target = [{ name = \"T1\", at = [\"0 m\", \"1 m\", \"2 m\"] }, { name = \"T2\", at = [\"3 m\", \"1 m\", \"2 m\"] }]\n"
    "station = [{ name = \"S1\" }, { name = \"S2\", at = [\"1 m\", \"2 m\", \"3 m\"], sigma = [\"1 mm\", \"1 mm\", \"2 mm\"] }]\n"
    "point = [{ name = \"roof\", role = \"antenna\", offset = [\"0 m\", \"0 m\", \"-15 mm\"] }, { name = \"P\" }]\n";

class HangarFiles : public ::testing::Test {
 protected:
  HangarSurvey read(const std::string& text, const std::string& start = head) {
    test::write_bytes(folder_ / "hangar.toml", start + text);
    return read_hangar(folder_ / "hangar.toml");
  }
  /// "file:line: what" of the error.
  std::string fault(const std::string& text, const std::string& start = head) {
    try {
      read(text, start);
    } catch (const core::Error& e) {
      hint_ = e.hint();
      EXPECT_FALSE(hint_.empty() && e.code() != core::Exit::bad_usage) << e.what();
      const std::string where = e.where().substr(e.where().rfind('/') + 1);
      return where + ": " + e.what();
    }
    return "no error";
  }
  bool says(const std::string& text, const std::string& words) {
    const std::string f = fault(text);
    EXPECT_NE(f.find(words), std::string::npos) << f;
    return f.find(words) != std::string::npos;
  }
  test::TemporaryFolder folder_;
  std::string hint_;
};

TEST_F(HangarFiles, ValuesAndWhatTheInstrumentFillsIn) {
  const HangarSurvey h = read(
      "instrument = { angle = \"3 arcsec\", distance = \"1 mm\", distance_scale = \"10 ppm\" }\n"
      "distance = [{ from = \"S1\", to = \"T1\", distance = \"10 m\" }, { from = \"S1\", to = \"roof\", distance = \"5 m\", sigma = \"4 "
      "mm\" }]\n"
      "angle = [{ at = \"S1\", from = \"S2\", to = \"roof\", angle = \"300 deg\" }]\n"
      "vertical = [{ at = \"S1\", to = \"roof\", angle = \"-10 deg\" }]\n");
  EXPECT_EQ(h.points[0].role, HangarRole::antenna);
  EXPECT_EQ(h.points[0].offset[2].value, -0.015);
  EXPECT_EQ(h.points[1].role, HangarRole::mark);
  EXPECT_NEAR(h.distances[0].sigma->value, 0.0011, rounding);
  EXPECT_EQ(h.distances[1].sigma->value, 0.004);
  EXPECT_NEAR(h.angles[0].angle.value, core::degrees(60).value, rounding);  // counted the other way round
  EXPECT_NEAR(h.angles[0].sigma->value, core::degrees(3.0 / 3600).value, rounding);
  EXPECT_NEAR(h.verticals[0].angle.value, core::degrees(-10).value, rounding);
  EXPECT_TRUE(h.distances[1].place.find("hangar.toml:6:") != std::string::npos) << h.distances[1].place;
  EXPECT_TRUE(hangar_tables(h).empty());
}

TEST_F(HangarFiles, TablesAndTheirUnits) {
  test::write_bytes(folder_ / "t.csv", "name,x,y,z\nW1,10,20,30\n");
  test::write_bytes(folder_ / "d.csv", "from;to;distance;sigma\nS1;W1;10;\nS1;T1;20;0.5\n");
  test::write_bytes(folder_ / "a.csv", "at,from,to,angle\nS1,S2,P,50\n");
  test::write_bytes(folder_ / "v.csv", "at,to,angle,sigma\nS1,P,110,0.01\n");
  const std::string files = "targets_file = \"t.csv\"\ndistances_file = \"d.csv\"\nangles_file = \"a.csv\"\nverticals_file = \"v.csv\"\n";
  const HangarSurvey h = read(files + "length_unit = \"1 ft\"\nangle_unit = \"gon\"\nvertical_from = \"zenith\"\n");
  EXPECT_NEAR(h.targets[2].at[0].value, 3.048, rounding);
  EXPECT_NEAR(h.distances[0].distance.value, 3.048, rounding);
  EXPECT_NEAR(h.distances[1].sigma->value, 0.1524, rounding);
  EXPECT_NEAR(h.angles[0].angle.value, core::degrees(45).value, rounding);
  EXPECT_NEAR(h.verticals[0].angle.value, core::degrees(-9).value, rounding);
  EXPECT_NEAR(h.verticals[0].sigma->value, core::degrees(0.009).value, rounding);
  EXPECT_EQ(hangar_tables(h).size(), 4u);
  EXPECT_TRUE(says(files, "a.csv:2: the unit of its angles is not stated"));
  test::write_bytes(folder_ / "d.csv", "from,to,distance,sigma\nS1,W1,10,-1\n");
  EXPECT_TRUE(says(files, "d.csv:2: the sigma is -1"));
  test::write_bytes(folder_ / "d.csv", "from,to,distance\nS1,W2,10\n");
  EXPECT_TRUE(says(files + "angle_unit = \"gon\"\n", "d.csv:2: no target or point 'W2'"));
  EXPECT_EQ(hint_, "did you mean 'T2'?");
}

TEST_F(HangarFiles, NamesAreHeldToTheirKinds) {
  EXPECT_TRUE(says("distance = [{ from = \"S1\", to = \"T11\", distance = \"10 m\" }]\n", "no target or point 'T11'"));
  EXPECT_EQ(hint_, "did you mean 'T1'?");
  EXPECT_TRUE(says("distance = [{ from = \"T1\", to = \"T2\", distance = \"10 m\" }]\n", "'T1' is a target, a station is needed"));
  EXPECT_TRUE(says("angle = [{ at = \"S1\", from = \"S1\", to = \"P\", angle = \"10 deg\" }]\n", "counts from the station itself"));
  EXPECT_TRUE(says("vertical = [{ at = \"S1\", to = \"T1\", angle = \"10 deg\" }]\n", "'T1' is a target, a point is needed"));
  EXPECT_NE(fault("", "target = [{ name = \"A\" }]\nstation = [{ name = \"A\" }]\n").find("'A' stands twice"), std::string::npos);
  EXPECT_NE(fault("", "target = [{ at = [\"0 m\", \"0 m\", \"0 m\"] }]\n").find("a target has no name"), std::string::npos);
  EXPECT_NE(fault("", "point = [{ name = \"A\", role = \"imu\" }, { name = \"B\", role = \"imu\" }]\n").find("more than one point"),
            std::string::npos);
}

TEST_F(HangarFiles, ValuesOutsideTheirRange) {
  const std::string d =
      "distance = [{ from = \"S1\", to = \"T1\", distance = \"10 m\" }, { from = \"S1\", to = \"T1\", distance = \"10 m\" }]\n";
  EXPECT_TRUE(says(d, "stated before, as "));
  EXPECT_TRUE(says("distance = [{ from = \"S1\", to = \"T1\", distance = \"6743 m\" }]\n", "the distance is 6743 m"));
  EXPECT_TRUE(says("distance = [{ from = \"S1\", to = \"T1\" }]\n", "the distance is 0 m"));
  EXPECT_TRUE(says("distance = [{ from = \"S1\", to = \"T1\", distance = 10 }]\n", "10"));
  EXPECT_TRUE(says("angle = [{ at = \"S1\", from = \"S2\", to = \"P\", angle = \"-10 deg\" }]\n", "the angle is -10 deg"));
  EXPECT_TRUE(says("angle = [{ at = \"S1\", from = \"S2\", to = \"P\", angle = \"400 deg\" }]\n", "the angle is 400 deg"));
  EXPECT_TRUE(says("vertical = [{ at = \"S1\", to = \"P\", angle = \"97 deg\" }]\n", "the vertical angle is 97 deg"));
  EXPECT_NE(hint_.find("zenith"), std::string::npos);
  EXPECT_TRUE(
      says("angle = [{ at = \"S1\", from = \"S2\", to = \"P\", angle = \"100 deg\" }, { at = \"S2\", from = \"S1\", to = \"P\", angle = "
           "\"85 deg\" }]\n",
           "make 185 deg: their sights do not meet"));
  EXPECT_NE(fault("", "station = [{ name = \"S\", at = [\"0 m\", \"0 m\", \"0 m\"] }]\n").find("`at` and `sigma` go together"),
            std::string::npos);
}

}  // namespace
}  // namespace swath::io
