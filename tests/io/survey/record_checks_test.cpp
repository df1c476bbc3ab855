// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/record_checks.h"

#include "core/error.h"
#include "io/survey/read_survey.h"
#include "io/text/value_file.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

class RecordChecks : public ::testing::Test {
 protected:
  std::string fault_of(const std::string& survey) {
    test::write_bytes(folder_ / "survey.toml", survey);
    const core::Value tree = read_value_file(folder_ / "survey.toml");
    try {
      check_records(read_survey(tree, folder_.path()), tree);
    } catch (const core::Error& e) {
      EXPECT_EQ(e.code(), core::Exit::bad_usage);
      return e.text();
    }
    return {};
  }
  static std::string laser(const std::string& unit, const std::string& range = "r") {
    return "crs = \"EPSG:32632\"\n[[trajectory]]\nfile = \"t.csv\"\nangle_unit = \"deg\"\ntime = {scale = \"gps\"}\n"
           "columns = {time = \"t\", latitude = \"lat\", longitude = \"lon\", height = \"h\", roll = \"ro\", pitch = \"pi\", heading = "
           "\"he\"}\n"
           "[[laser]]\nfile = \"l.csv\"\nangle_unit = \"" +
           unit + "\"\ntime = {scale = \"gps\"}\ncolumns = {time = \"t\", range = \"" + range + "\", scan_angle = \"a\"}\n";
  }
  void SetUp() override {
    test::write_bytes(folder_ / "l.csv", "t,r,a\n1,500,-30\n2,500,0\n3,500,30\n");
    test::write_bytes(folder_ / "t.csv", "t,lat,lon,h,ro,pi,he\n1,48,11,500,0,0,0\n");
  }
  test::TemporaryFolder folder_;
};

TEST_F(RecordChecks, NamedColumnsThatAreNotThere) {
  EXPECT_EQ(fault_of(laser("deg")), "");
  const std::string text = fault_of(laser("deg", "rnage"));
  EXPECT_NE(text.find("laser[1].columns.range"), std::string::npos) << text;
  EXPECT_NE(text.find("l.csv"), std::string::npos) << text;
  test::write_bytes(folder_ / "t.csv", "t,lat,lon,h,ro,pi\n1,48,11,500,0,0\n");
  const std::string both = fault_of(laser("deg", "rnage"));
  EXPECT_NE(both.find("trajectory[1].columns.heading"), std::string::npos) << both;
  EXPECT_NE(both.find("laser[1].columns.range"), std::string::npos) << both;
}

TEST_F(RecordChecks, DegreesStatedAsRadians) {
  const std::string text = fault_of(laser("rad"));
  EXPECT_NE(text.find("laser[1].angle_unit"), std::string::npos) << text;
  EXPECT_NE(text.find("more than a full turn"), std::string::npos) << text;
  EXPECT_NE(text.find("angle_unit = \"deg\""), std::string::npos) << text;
  test::write_bytes(folder_ / "l.csv", "t,r,a\n1,500,-0.5\n2,500,0\n3,500,0.5\n");
  EXPECT_EQ(fault_of(laser("rad")), "");
}

TEST_F(RecordChecks, DamagedFilesAreLeftToTheirReaders) {
  test::write_bytes(folder_ / "l.csv", "");
  EXPECT_EQ(fault_of(laser("deg")), "");
}

}  // namespace
}  // namespace swath::io
