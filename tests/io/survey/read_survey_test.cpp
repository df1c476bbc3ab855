// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/read_survey.h"

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "io/survey/calibration_file.h"
#include "io/text/value_file.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

const std::string good =
    "name = \"a\"\n"
    "crs = \"EPSG:32632\"\n"
    "[[laser]]\n"
    "file = \"laser.csv\"\n"
    "angle_unit = \"deg\"\n"
    "time = {scale = \"gps_week\", week = 2317}\n"
    "columns = {time = \"t\", line = \"line\", range = \"r\", scan_angle = \"a\"}\n"
    "[[trajectory]]\n"
    "file = \"sbet.out\"\n"
    "time = {scale = \"gps_week\", week = 2317}\n"
    "[line_time]\n"
    "scale = \"gps_week\"\n"
    "week = 2317\n"
    "[[line]]\n"
    "id = 2\n"
    "start = \"100 s\"\n"
    "end = \"200 s\"\n"
    "[[line]]\n"
    "id = 1\n"
    "start = \"10 s\"\n"
    "end = \"20 s\"\n";

class SurveyFile : public ::testing::Test {
 protected:
  SurveyFile() {
    for (const char* name : {"laser.csv", "sbet.out", "p.las", "a.csd", "x.dat"}) test::write_bytes(folder_ / name, "x");
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
  static std::string with(const std::string& from, const std::string& to, std::string text = good) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
  test::TemporaryFolder folder_;
};

TEST_F(SurveyFile, WhichSigmasAreStatedIsKept) {
  EXPECT_TRUE(read(good).sigma.stated.empty());
  const Survey s = read(good + "[sigma]\nroll = \"0.3 deg\"\nscan_scale = 1e-4\n");
  EXPECT_EQ(s.sigma.stated, (std::vector<std::string>{"roll", "scan_scale"}));
  test::write_bytes(folder_ / "c.json", R"({"calibration": {"roll": "1 deg"}, "sigma": {"pitch": "0.01 deg"}})");
  const Survey c = read("calibration_file = \"c.json\"\n" + good + "[sigma]\nroll = \"0.3 deg\"\n");
  EXPECT_EQ(c.sigma.stated, (std::vector<std::string>{"roll", "pitch"}));
}

TEST_F(SurveyFile, TheNoiseOfRecordsIsTheSurveysOwn) {
  test::write_bytes(folder_ / "c.json", R"({"calibration": {}, "sigma": {"roll": "0.01 deg", "range": "2 cm", "scan_angle": "0.02 deg"}})");
  const Survey s = read("calibration_file = \"c.json\"\n" + good + "[sigma]\nroll = \"0.3 deg\"\nrange = \"1.5 cm\"\n");
  EXPECT_DOUBLE_EQ(s.sigma.range.value, 0.015);
  EXPECT_DOUBLE_EQ(s.sigma.scan_angle.value, 0.02 * core::degree);  // the survey does not say
  EXPECT_DOUBLE_EQ(s.sigma.roll.value, 0.01 * core::degree);        // the calibration's
}

TEST_F(SurveyFile, CorrelationsOfACalibrationAreRead) {
  const auto with_correlation = [&](const std::string& table) {
    test::write_bytes(folder_ / "c.json", R"({"calibration": {"roll": "1 deg"}, "correlation": )" + table + "}");
    return "calibration_file = \"c.json\"\n" + good;
  };
  const Survey s = read(with_correlation(R"({"parameters": ["scan_scale", "boresight_roll"], "matrix": [[1, -0.4], [-0.4, 1]]})"));
  ASSERT_EQ(s.sigma.correlation.size(), 121u);
  EXPECT_EQ(s.sigma.correlation[0 * 11 + 9], -0.4);
  EXPECT_EQ(s.sigma.correlation[9 * 11 + 0], -0.4);
  EXPECT_EQ(s.sigma.correlation[1 * 11 + 1], 1.0);
  EXPECT_EQ(s.sigma.correlation[1 * 11 + 9], 0.0);
  core::Calibration c;
  core::SensorSigma back;
  test::write_bytes(folder_ / "again.json", to_json(calibration_tree(s.calibration, s.sigma)));
  load_calibration(folder_ / "again.json", c, back);
  EXPECT_EQ(back.correlation, s.sigma.correlation);
  for (const auto& [table, what] : std::vector<std::pair<std::string, std::string>>{
           {R"({"parameters": ["roll"], "matrix": [[1]]})", "not a calibration value"},
           {R"({"parameters": ["boresight_roll"], "matrix": [[1], [1]]})", "as many rows"},
           {R"({"parameters": ["boresight_roll", "latency"], "matrix": [[1, 2], [2, 1]]})", "-1 to 1"},
           {R"({"parameters": ["boresight_roll", "latency"], "matrix": [[1, 0.2], [0.1, 1]]})", "not symmetric"},
           {R"({"parameters": ["boresight_roll", "latency"], "matrix": [[1, 0.2], [0.2]]})", "row 2 has another length"}})
    EXPECT_NE(fault_of(with_correlation(table)).find(what), std::string::npos) << table;
}

TEST_F(SurveyFile, AGoodOneIsRead) {
  const Survey s = read(good);
  EXPECT_EQ(s.laser.at(0).columns.scan_angle, "a");
  EXPECT_EQ(resolve(s, s.laser[0].file), folder_ / "laser.csv");
  const auto windows = line_windows(s);
  ASSERT_EQ(windows.size(), 2u);
  EXPECT_EQ(windows[0].id, 1);
  EXPECT_EQ(windows[1].end, 2317 * 604800.0 + 200);
  EXPECT_EQ(format_of(s.trajectory[0]), TrajectoryFormat::sbet);
}

/// line[1] is the flight's second one; after it a third.
TEST_F(SurveyFile, ALineMayCrossTheEndOfTheWeekOrOfTheDay) {
  const auto crossing = [&](const std::string& scale, const std::string& start, const std::string& end) {
    const std::string week = "scale = \"gps_week\"\nweek = 2317\n";
    return good.substr(0, good.find("[line_time]")) + "[line_time]\n" + (scale.empty() ? week : scale) + "[[line]]\nid = 7\nstart = \"" +
           start + "\"\nend = \"" + end + "\"\n[[line]]\nid = 8\nstart = \"90 s\"\nend = \"140 s\"\n";
  };
  std::vector<LineWindow> w = line_windows(read(crossing("", "604780 s", "30 s")));
  ASSERT_EQ(w.size(), 2u);
  EXPECT_EQ(w[0].id, 7);
  EXPECT_EQ(w[0].start, 2317 * 604800.0 + 604780);
  EXPECT_EQ(w[0].end, 2318 * 604800.0 + 30);
  EXPECT_EQ(w[1].start, 2318 * 604800.0 + 90);
  const std::string day = "scale = \"utc_day\"\ndate = \"2024-06-05\"\n";
  w = line_windows(read(crossing(day, "86390 s", "40 s")));
  EXPECT_EQ(w[0].end - w[0].start, 50.0);
  EXPECT_EQ(w[1].start - w[0].end, 50.0);
  for (const auto& [text, hint] : {std::pair(crossing("", "580000 s", "30 s"), "may last 6 h at most"),
                                   std::pair(crossing("", "500 s", "500 s"), "may last 6 h at most"),
                                   std::pair(crossing("scale = \"gps\"\n", "604780 s", "30 s"), "gps_week or utc_day")}) {
    EXPECT_NE(fault_of(text).find("the line must end after it starts"), std::string::npos) << fault_of(text);
    EXPECT_NE(fault_of(text).find(hint), std::string::npos) << fault_of(text);
  }
}

TEST_F(SurveyFile, EachFaultIsNamedWithItsPlace) {
  struct Case {
    std::string text, place, words;
  };
  const std::vector<Case> cases{
      {with("laser.csv", "lasr.csv"), "survey.toml:4", "no such file"},
      {with("crs = \"EPSG:32632\"\n", ""), "crs", "missing"},
      {with("EPSG:32632", "EPSG:1"), "survey.toml:2", "crs"},
      {with("angle_unit = \"deg\"\n", ""), "laser[1].angle_unit", "not stated"},
      {with("scale = \"gps_week\", week = 2317", "week = 2317"), "laser[1].time.scale", "not stated"},
      {with("scale = \"gps_week\", week = 2317", "scale = \"gps_week\""), "laser[1].time.week", "needs the GPS week"},
      {with("scale = \"gps_week\", week = 2317", "scale = \"utc_day\", date = \"2024-13-01\""), "survey.toml:6", "no date"},
      {with("scale = \"gps_week\", week = 2317", "scale = \"utc_day\""), "laser[1].time.date", "needs the UTC date"},
      {with("scale = \"gps_week\", week = 2317", "scale = \"gps\", week = 2317"), "survey.toml:6", "only"},
      {with("range = \"r\", ", ""), "laser[1].columns.range", "ranges is not named"},
      {with(", scan_angle = \"a\"", ""), "laser[1].columns.scan_angle", "not named"},
      {with("time = \"t\", ", ""), "laser[1].columns.time", "not named"},
      {with("range = \"r\"", "range = \"r\", x = \"x\""), "laser[1].columns", "x, y and z go together"},
      {with("line = \"line\", ", "line = \"line\", week = \"w\", "), "laser[1].time.week", "column"},
      {with("angle_unit", "line = 4\nangle_unit"), "laser[1].line", "no effect"},
      {with("laser.csv", "x.dat"), "laser[1].format", "ending"},
      {with("[[trajectory]]\nfile = \"sbet.out\"\ntime = {scale = \"gps_week\", week = 2317}\n", ""), "trajectory",
       "need a [[trajectory]]"},
      {good + "[[points]]\nfile = \"p.las\"\n", "points", "not both"},
      {with("id = 1", "id = 2"), "line[2].id", "taken"},
      {with("end = \"20 s\"", "end = \"150 s\""), "line[1].start", "before line[2] ends"},
      {with("end = \"20 s\"", "end = \"5 s\""), "line[2]", "must end after"},
      {with("[line_time]\nscale = \"gps_week\"\nweek = 2317\n", ""), "line_time.scale", "not stated"},
      {with("[line_time]", "[scanner]\nmodel = \"beam\"\n[line_time]"), "scanner.model", "x, y, z"},
      {with("range = \"r\", scan_angle = \"a\"", "x = \"x\", y = \"y\", z = \"z\""), "laser[1].angle_unit", "no effect"},
      {with("sbet.out\"", "sbet.out\"\nformat = \"text\""), "trajectory[1].columns.latitude", "not named"},
      {with("sbet.out\"", "sbet.out\"\nformat = \"text\""), "trajectory[1].angle_unit", "not stated"},
      {with("sbet.out\"", "sbet.out\"\ncrs = \"EPSG:32632\""), "trajectory[1].crs", "no effect"},
      {with("laser.csv\"", "laser.csv\"\ncolums = 1"), "laser[1].colums", "did you mean 'columns'"},
      {good + "[truth]\ndtm = \"none.tif\"\n", "truth.dtm", "no such file"},
      {"calibration_file = \"none.json\"\n" + good, "calibration_file", "no such file"},
  };
  for (const Case& c : cases) {
    const std::string text = fault_of(c.text);
    EXPECT_NE(text.find(c.place), std::string::npos) << c.words << "\n" << text;
    EXPECT_NE(text.find(c.words), std::string::npos) << c.place << "\n" << text;
  }
}

TEST_F(SurveyFile, AllFaultsAtOnce) {
  std::string text = with("laser.csv", "none.csv");
  text = with("angle_unit = \"deg\"\n", "", text);
  text = with("id = 1", "id = 2", text);
  EXPECT_NE(fault_of(text).find("3 faults"), std::string::npos) << fault_of(text);
}

TEST_F(SurveyFile, CsdCarriesItsOwnTrajectoryAndTime) {
  const std::string head = "crs = \"EPSG:32616\"\n[[laser]]\nfile = \"a.csd\"\n";
  EXPECT_NE(fault_of(head).find("boresight"), std::string::npos);
  const Survey s = read(head + "[calibration]\nroll = \"0.1 deg\"\n");
  ASSERT_EQ(trajectory_files(s).size(), 1u);
  EXPECT_EQ(format_of(trajectory_files(s)[0]), TrajectoryFormat::csd);
}

TEST_F(SurveyFile, ACalibrationFileReplacesWhatItStates) {
  const std::string text = "calibration_file = \"c.json\"\n" + good + "[calibration]\nroll = \"1 deg\"\npitch = \"2 deg\"\n";
  for (const char* file :
       {"{\"calibration\": {\"roll\": \"0.5 deg\", \"lever_arm_scanner\": [\"1 m\", \"2 m\", \"3 m\"]}, \"sigma\": {\"range\": \"3 cm\"}, "
        "\"correlations\": 1}",
        "{\"roll\": \"0.5 deg\", \"lever_arm_scanner\": [\"1 m\", \"2 m\", \"3 m\"], \"sigma\": {\"range\": \"3 cm\"}}"}) {
    test::write_bytes(folder_ / "c.json", file);
    const Survey s = read(text);
    EXPECT_DOUBLE_EQ(core::to_degrees(s.calibration.roll), 0.5);
    EXPECT_DOUBLE_EQ(core::to_degrees(s.calibration.pitch), 2);
    EXPECT_EQ(s.calibration.lever_arm_scanner[2].value, 3);
    EXPECT_DOUBLE_EQ(s.sigma.range.value, 0.03);
  }
  test::write_bytes(folder_ / "c.json", "{\"calibration\": {\"rol\": \"0.5 deg\"}}");
  EXPECT_NE(fault_of(text).find("did you mean 'roll'"), std::string::npos);
  core::Calibration c;
  c.heading = core::degrees(0.25);
  c.scan_scale = 1.0002;
  core::SensorSigma sigma;
  sigma.latency.value = 1e-6;
  test::write_bytes(folder_ / "c.json", to_json(calibration_tree(c, sigma)));
  const Survey s = read(text);
  EXPECT_EQ(s.calibration.heading, c.heading);
  EXPECT_EQ(s.calibration.scan_scale, c.scan_scale);
  EXPECT_EQ(s.sigma.latency, sigma.latency);
}

TEST_F(SurveyFile, EveryOptionIsDocumented) {
  Survey s;
  for (const core::OptionDoc& o : core::document_options(core::described(s))) EXPECT_FALSE(o.doc.empty()) << o.path;
}

}  // namespace
}  // namespace swath::io
