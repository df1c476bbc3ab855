// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/survey_file.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/value_file.h"

namespace swath::simulate {
namespace {

using core::Value;

TEST(SurveyFile, TomlReadsBackToTheSameTree) {
  Value v = Value::object();
  v["text"] = "a \"quoted\" \\ back";
  v["number"] = 1e-9;
  v["whole"] = 3.0;
  v["integer"] = 42;
  v["yes"] = true;
  v["list"].push("1 m");
  v["list"].push("2 m");
  v["table"]["inner"]["deep"] = 1;
  v["table"]["value"] = 2;
  for (int i = 0; i < 2; ++i) {
    Value row = Value::object();
    row["id"] = i;
    row["part"]["x"] = 0.5;
    v["row"].push(row);
  }
  const Value back = io::parse_toml(toml_of(v), "made");
  EXPECT_EQ(back.find("text")->as_text(), v.find("text")->as_text());
  EXPECT_EQ(back.find("number")->as_number(), 1e-9);
  EXPECT_FALSE(back.find("whole")->is_int());
  EXPECT_EQ(back.find("integer")->as_int(), 42);
  EXPECT_EQ(back.find("list")->items().size(), 2u);
  EXPECT_EQ(back.find("table")->find("inner")->find("deep")->as_int(), 1);
  EXPECT_EQ(back.find("table")->find("value")->as_int(), 2);
  ASSERT_EQ(back.find("row")->items().size(), 2u);
  EXPECT_EQ(back.find("row")->items()[1].find("part")->find("x")->as_number(), 0.5);
}

TEST(SurveyFile, RefusesWhatTomlListsCannotHold) {
  Value v = Value::object();
  v["list"].push(1);
  v["list"].push(Value::object());
  EXPECT_THROW(toml_of(v), core::Error);
}

TEST(SurveyFile, LeavesOutDefaultsAndStatesCalibrationInFull) {
  io::Survey s;
  s.crs = "EPSG:32632";
  s.laser.resize(1);
  s.laser[0].file = "laser.npy";
  const std::string text = survey_toml(s, "# note\n");
  EXPECT_EQ(text.rfind("# note\n", 0), 0u);
  EXPECT_NE(text.find("[calibration]\nroll = \"0 deg\""), std::string::npos) << text;
  EXPECT_NE(text.find("[sigma]"), std::string::npos);
  EXPECT_NE(text.find("model = \"mirror\""), std::string::npos);
  EXPECT_EQ(text.find("wavelength"), std::string::npos);
  EXPECT_EQ(text.find("delimiter"), std::string::npos);
}

}  // namespace
}  // namespace swath::simulate
