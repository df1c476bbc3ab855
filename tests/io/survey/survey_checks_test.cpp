// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/survey_checks.h"

#include "core/error.h"
#include "io/survey/read_survey.h"
#include "io/text/value_file.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

const std::string antenna = "[antenna]\nlever_arm = [\"0 m\", \"0 m\", \"-1 m\"]\n";

const std::string navigation =
    "[[imu]]\n"
    "file = \"imu.csv\"\n"
    "time = {scale = \"device\", unit = \"1 ms\", origin = \"2025-07-08T19:34:21.985 GPS\", offset = \"-0.125 s\"}\n"
    "kind = \"rates\"\n"
    "angle_unit = \"deg\"\n"
    "acceleration_unit = \"g\"\n"
    "axes = [\"-x\", \"y\", \"-z\"]\n"
    "columns = {time = \"7\", gyro_x = \"4\", gyro_y = \"5\", gyro_z = \"6\", accelerometer_x = \"1\", accelerometer_y = \"2\", "
    "accelerometer_z = \"3\"}\n"
    "[[gnss]]\n"
    "file = \"gnss.csv\"\n"
    "time = {scale = \"gps\"}\n"
    "columns = {time = \"t\", latitude = \"lat\", longitude = \"lon\", height = \"h\", sigma_north = \"sn\", sigma_east = \"se\", "
    "sigma_up = \"su\"}\n"
    "[[gnss]]\n"
    "file = \"rover.pos\"\n"
    "[[gnss]]\n"
    "file = \"gps.log\"\n"
    "time = {date = \"2025-07-08\"}\n" +
    antenna;

const std::string laser =
    "crs = \"EPSG:32632\"\n"
    "[[laser]]\n"
    "file = \"laser.csv\"\n"
    "angle_unit = \"deg\"\n"
    "time = {scale = \"gps\"}\n"
    "columns = {time = \"t\", range = \"r\", scan_angle = \"a\"}\n";

class NavigationChecks : public ::testing::Test {
 protected:
  NavigationChecks() {
    for (const char* name : {"laser.csv", "x.dat", "imu.csv", "gnss.csv", "rover.pos", "gps.log"}) test::write_bytes(folder_ / name, "x");
  }
  Survey read(const std::string& text) {
    test::write_bytes(folder_ / "survey.toml", text);
    return read_survey(folder_ / "survey.toml");
  }
  std::string fault_of(const std::string& text) {
    try {
      read(text);
    } catch (const core::Error& e) {
      EXPECT_EQ(e.code(), core::Exit::bad_usage);
      return e.text();
    }
    return "";
  }
  static std::string with(const std::string& from, const std::string& to, std::string text) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
  test::TemporaryFolder folder_;
};

TEST_F(NavigationChecks, NavigationRecordsMakeASurveyByThemselves) {
  const Survey s = read(navigation);
  ASSERT_EQ(s.imu.size(), 1u);
  EXPECT_EQ(s.imu[0].time.unit.value, 0.001);
  EXPECT_EQ(s.imu[0].time.offset.value, -0.125);
  EXPECT_EQ(format_of(s.imu[0]), RecordFormat::text);
  EXPECT_EQ(format_of(s.gnss[0]), GnssFormat::text);
  EXPECT_EQ(format_of(s.gnss[1]), GnssFormat::pos);
  EXPECT_EQ(format_of(s.gnss[2]), GnssFormat::nmea);
  // With laser records they stand for the trajectory.
  EXPECT_EQ(fault_of(laser + navigation), "");
}

TEST_F(NavigationChecks, ImuAndGnssNeedTheAntennasLeverArm) {
  const std::string bare = with(antenna, "", navigation);
  EXPECT_NE(fault_of(bare).find("antenna.lever_arm"), std::string::npos) << fault_of(bare);
  EXPECT_NE(fault_of(bare + "[antenna]\nlatency = \"1 ms\"\n").find("antenna.lever_arm"), std::string::npos);
  const size_t gnss = bare.find("[[gnss]]");
  EXPECT_EQ(fault_of(bare.substr(gnss)), "");  // fixes alone
}

const std::string given =
    "[[trajectory]]\nfile = \"imu.csv\"\nangle_unit = \"deg\"\ntime = {scale = \"gps\"}\ncolumns = {time = \"t\", latitude = \"a\", "
    "longitude "
    "= \"o\", height = \"h\", roll = \"r\", pitch = \"p\", heading = \"y\"}\n";

TEST_F(NavigationChecks, ATrajectoryMayBeAllThatASurveyHas) { EXPECT_EQ(fault_of(given), ""); }

TEST_F(NavigationChecks, TheSameRecordsTwiceAreRefused) {
  const std::string again = "[[laser]]\nfile = \"./laser.csv\"\nangle_unit = \"deg\"\ntime = {scale = \"gps\"}\n";
  const std::string columns = "columns = {time = \"t\", range = \"r\", scan_angle = \"a\"}\n";
  EXPECT_NE(fault_of(laser + again + columns + given).find("laser[2].file"), std::string::npos);
  EXPECT_EQ(fault_of(laser + again + with("\"r\"", "\"r2\"", columns) + given), "") << "a second return of the same rows";
  EXPECT_EQ(fault_of(laser + again + columns + "line = 2\n" + given), "");
}

TEST_F(NavigationChecks, ALeverArmInMillimetresIsRefused) {
  const std::string text =
      fault_of(navigation.substr(0, navigation.find(antenna)) + "[antenna]\nlever_arm = [\"0 m\", \"0 m\", \"-1236 m\"]\n");
  EXPECT_NE(text.find("antenna.lever_arm"), std::string::npos) << text;
  EXPECT_NE(text.find("millimetres"), std::string::npos) << text;
}

TEST_F(NavigationChecks, AProfileLineInASurveyByAMirror) {
  const std::string lines = laser + "[[laser]]\nfile = \"laser.csv\"\ntime = {scale = \"gps\"}\ncolumns = {time = \"t\", range = \"r\"}\n";
  const std::string text = fault_of(lines + given);
  EXPECT_NE(text.find("laser[2].columns.scan_angle"), std::string::npos) << text;
  EXPECT_EQ(fault_of(lines + "model = \"profile\"\n" + given), "");
  EXPECT_NE(fault_of(lines + "model = \"palmer\"\n" + given).find("laser[2].model"), std::string::npos);
}

TEST_F(NavigationChecks, TheWeekOfACsdFile) {
  std::string bytes(2048, '\0');
  bytes.replace(0, 3, "CSD");
  bytes[104] = 0, bytes[105] = 8;            // size of the header
  bytes[106] = '\x64', bytes[107] = '\x05';  // week 1380
  test::write_bytes(folder_ / "a.csd", bytes);
  const std::string csd = "crs = \"EPSG:32632\"\ncalibration_file = \"a.csd\"\n[[laser]]\nfile = \"a.csd\"\n";
  EXPECT_EQ(fault_of(csd), "");
  EXPECT_EQ(fault_of(csd + "time = {week = 1380}\n"), "");
  const std::string text = fault_of(csd + "time = {week = 1381}\n");
  EXPECT_NE(text.find("laser[1].time.week"), std::string::npos) << text;
  EXPECT_NE(text.find("1381") != std::string::npos && text.find("1380") != std::string::npos, false) << text;
}

TEST_F(NavigationChecks, EventsAndClocks) {
  const std::string events =
      "[[event]]\nfile = \"imu.csv\"\ntime = {scale = \"unix\"}\ncolumns = {time = \"1\"}\n[[clock]]\nfile = \"x.dat\"\n";
  EXPECT_EQ(fault_of(events), "");
  EXPECT_NE(fault_of(with("x.dat", "y.dat", events)).find("no such file"), std::string::npos);
  EXPECT_NE(fault_of(with("imu.csv", "imv.csv", events)).find("no such file"), std::string::npos);
  EXPECT_NE(fault_of(with("scale = \"unix\"", "", events)).find("event[1].time.scale"), std::string::npos);
  EXPECT_NE(fault_of(with("columns = {time = \"1\"}", "", events)).find("event[1].columns.time"), std::string::npos);
}

TEST_F(NavigationChecks, FaultsOfNavigationRecords) {
  struct Case {
    std::string from, to, place, words;
  };
  const std::vector<Case> cases{
      {"imu.csv", "imv.csv", "survey.toml:2", "no such file"},
      {"imu.csv", "x.dat", "imu[1].format", "ending"},
      {"imu.csv", "imu.csv.GZ", "imu[1].file", "'imu.csv.GZ' is packed"},
      {"kind = \"rates\"\n", "", "imu[1].kind", "increments or rates"},
      {"angle_unit = \"deg\"\n", "", "imu[1].angle_unit", "not stated"},
      {"acceleration_unit = \"g\"\n", "", "imu[1].acceleration_unit", "not stated"},
      {"\"-z\"]", "\"z\"]", "imu[1].axes", "left-handed"},
      {"gyro_y = \"5\", ", "", "imu[1].columns.gyro_y", "not named"},
      {"kind = \"rates\"", "kind = \"increments\"\nsample = \"instant\"", "imu[1].sample", "no effect"},
      {"kind = \"rates\"", "kind = \"rates\"\nsample = \"instant\"\nstamp = \"middle\"", "imu[1].stamp", "no effect"},
      {"origin = \"2025-07-08T19:34:21.985 GPS\", ", "", "imu[1].time.origin", "needs the instant"},
      {"21.985 GPS", "21.985", "imu[1].time.origin", "no instant"},
      {"scale = \"device\"", "scale = \"gps\"", "imu[1].time.origin", "device only"},
      {"{scale = \"gps\"}", "{scale = \"gps\", origin_at = 5}", "gnss[1].time.origin_at", "device only"},
      {"{scale = \"gps\"}", "{}", "gnss[1].time.scale", "not stated"},
      {"time = \"t\", ", "", "gnss[1].columns.time", "not named"},
      {"height = \"h\", ", "", "gnss[1].columns", "latitude, longitude and height go together"},
      {"height = \"h\", ", "height = \"h\", x = \"x\", y = \"y\", z = \"z\", ", "gnss[1].columns", "not both"},
      {"height = \"h\", ", "height = \"h\", cov_xx = \"x\", ", "gnss[1].columns", "six cov_ columns go together"},
      {"height = \"h\", ", "height = \"h\", sigma_v_north = \"a\", sigma_v_east = \"b\", sigma_v_up = \"c\", ", "gnss[1].columns",
       "without v_north"},
      {"latitude = \"lat\", longitude = \"lon\", height = \"h\", ", "", "gnss[1].columns", "no columns of positions"},
      {"rover.pos\"", "rover.pos\"\nangle_unit = \"rad\"", "gnss[2].angle_unit", "no effect"},
      {"rover.pos\"", "rover.pos\"\ntime = {scale = \"gps\"}", "gnss[2].time.scale", "no effect"},
      {"rover.pos\"", "rover.pos\"\ntime = {unit = \"1 ms\"}", "gnss[2].time.unit", "no effect"},
      {"rover.pos\"", "rover.pos\"\ntime = {date = \"2025-07-08\"}", "gnss[2].time.date", "no effect"},
      {"rover.pos\"", "rover.pos\"\ngeoid_height = true", "gnss[2].geoid_height", "not read"},
      {"rover.pos\"", "rover.pos\"\ncolumns = {time = \"t\"}", "gnss[2].columns", "no effect"},
      {"gps.log\"", "gps.log\"\nbase = [\"1 m\", \"2 m\", \"3 m\"]", "gnss[3].base", "no effect"},
      {"2025-07-08\"}", "2025-07-32\"}", "gnss[3].time.date", "no date"},
  };
  test::write_bytes(folder_ / "imu.csv.GZ", "");
  for (const Case& c : cases) {
    const std::string text = fault_of(with(c.from, c.to, navigation));
    EXPECT_NE(text.find(c.place), std::string::npos) << c.to << "\n" << text;
    EXPECT_NE(text.find(c.words), std::string::npos) << c.to << "\n" << text;
    EXPECT_EQ(text.find("faults"), std::string::npos) << c.to << "\n" << text;
  }
  const std::string lines = "[[line]]\nid = 1\nstart = \"1 s\"\nend = \"2 s\"\n";
  EXPECT_EQ(fault_of(navigation + "[line_time]\nscale = \"gps\"\noffset = \"1 s\"\n" + lines), "");
  EXPECT_NE(fault_of(navigation + "[line_time]\nscale = \"gps\"\nunit = \"1 ms\"\n" + lines).find("line_time.unit"), std::string::npos);
}

TEST_F(NavigationChecks, AHangarMayBeAllThatASurveyHas) {
  test::write_bytes(folder_ / "hangar.toml", "");
  EXPECT_EQ(fault_of("hangar = \"hangar.toml\"\n"), "");
  EXPECT_NE(fault_of("hangar = \"none.toml\"\n").find("survey.toml:1:10: hangar: no such file"), std::string::npos);
  EXPECT_NE(fault_of("name = \"a\"\n").find("no records"), std::string::npos);
}

TEST_F(NavigationChecks, ControlFilesMustBeThere) {
  const std::string text = "hangar = \"x.dat\"\n[[control]]\nfile = \"";
  EXPECT_EQ(fault_of(text + "imu.csv\"\n"), "");
  EXPECT_NE(fault_of(text + "none.csv\"\n").find("control[1].file: no such file"), std::string::npos);
}

TEST(SurveyChecks, RecordsOfTheCallerNeedNoFiles) {
  const test::TemporaryFolder folder;
  const core::Value tree = parse_toml("crs = \"EPSG:32632\"\n", "survey");
  EXPECT_THROW(read_survey(tree, folder.path()), core::Error);
  EXPECT_EQ(read_survey(tree, folder.path(), RecordsIn::memory).crs, "EPSG:32632");
  test::write_bytes(folder / "laser.csv", "x");
  const core::Value flight = parse_toml(
      "crs = \"EPSG:32632\"\n[[laser]]\nfile = \"laser.csv\"\nangle_unit = \"deg\"\ntime = {scale = \"gps\"}\n"
      "columns = {time = \"t\", range = \"r\", scan_angle = \"a\"}\n",
      "survey");
  EXPECT_THROW(read_survey(flight, folder.path()), core::Error);  // without a trajectory
  EXPECT_EQ(read_survey(flight, folder.path(), RecordsIn::memory).laser.size(), 1u);
}

}  // namespace
}  // namespace swath::io
