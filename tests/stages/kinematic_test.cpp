// SPDX-License-Identifier: GPL-3.0-or-later
// The stage trajectory.kinematic, run on its own.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "io/raster/png.h"
#include "io/text/value_file.h"
#include "stages/registry.h"
#include "tests/trajectory/made_flight.h"
#include "tests/world/support.h"

namespace swath::stages {
namespace {

constexpr double start = 1.4e9;

/// A made flight over UTM zone 32 with events, and the stage's context.
struct Trial {
  test::TemporaryFolder folder;
  io::Survey survey;
  Context context{survey};
  trajectory::test::MadeFlight flight{1};
  trajectory::LocalFrame frame = trajectory::local_frame(core::ecef_of({48 * core::degree, 9 * core::degree, 1000.0}));
  core::GnssData gnss;
  core::EventData events;
  std::unique_ptr<Stage> stage = make_stage("trajectory.kinematic");
  core::Tally tally;
  core::Value findings;

  explicit Trial(const std::string& crs = "EPSG:32632") {
    survey.name = "made";
    context.crs = core::Crs(crs);
    context.product_crs = crs;
    context.unit = context.crs.metres_per_unit();
    context.output = folder.path();
    const trajectory::PointFixes fixes = flight.fixes(60, 1.0);
    for (size_t i = 0; i < fixes.size(); ++i) {
      gnss.time.push_back(start + fixes.time[i]);
      gnss.position.push_back(frame.to_ecef(fixes.position[i]));
      gnss.covariance.push_back(frame.local_R_ecef.transpose() * fixes.covariance[i] * frame.local_R_ecef);
      gnss.quality.push_back(core::FixQuality::fixed);
      gnss.satellites.push_back(9);
    }
  }
  void event(double seconds, const std::string& id, double sigma = 0.0, bool doubtful = false) {
    events.time.push_back(start + seconds);
    events.sigma.push_back(sigma);
    events.id.push_back(id);
    events.strip.push_back(7);
    events.technique.push_back("pc");
    events.doubtful.push_back(doubtful);
  }
  void set(const std::string& json) {
    std::vector<core::Fault> faults;
    core::read_options([&](core::Visitor& v) { stage->visit(v); }, io::parse_json(json, "options"), "", faults);
    for (const auto& f : faults) ADD_FAILURE() << f.text();
  }
  void go() {
    context.records.put(gnss);
    context.records.put(events);
    stage->run_survey(context, tally, findings);
  }
  /// Rows of the table by column name.
  std::vector<std::map<std::string, std::string>> rows(const std::string& name = "events.csv") const {
    std::istringstream in(test::read_bytes(folder / name));
    std::string line;
    const auto split = [](const std::string& text) {
      std::vector<std::string> out(1);
      for (const char c : text)
        if (c == ',')
          out.emplace_back();
        else
          out.back() += c;
      return out;
    };
    std::getline(in, line);
    const auto names = split(line);
    std::vector<std::map<std::string, std::string>> out;
    while (std::getline(in, line)) {
      const auto values = split(line);
      EXPECT_EQ(values.size(), names.size()) << line;
      out.emplace_back();
      for (size_t k = 0; k < names.size(); ++k) out.back()[names[k]] = values[k];
    }
    return out;
  }
};

Eigen::Vector3d three(std::map<std::string, std::string>& row, const char* a, const char* b, const char* c) {
  return {std::stod(row[a]), std::stod(row[b]), std::stod(row[c])};
}

TEST(KinematicStage, WritesPositionsVelocitiesAndSigmas) {
  Trial run;
  run.event(20.4, "A1", 0.001);
  run.event(33.7, "A2");
  run.go();
  auto rows = run.rows();
  ASSERT_EQ(rows.size(), 2u);
  const core::Transform to_map(core::wgs84_ecef(), run.context.crs);
  constexpr double error = 0.2;        // m: five sigma of an event's error at 1 Hz
  constexpr double rounding = 0.0002;  // m: four decimals, twice
  for (const auto& [row, t] : {std::pair{&rows[0], 20.4}, std::pair{&rows[1], 33.7}}) {
    const Eigen::Vector3d ecef = three(*row, "x", "y", "z"), map = three(*row, "easting", "northing", "height");
    EXPECT_LT((ecef - run.frame.to_ecef(run.flight.position(t))).norm(), error);
    EXPECT_LT((map - to_map(ecef)).norm(), rounding);
    EXPECT_LT((three(*row, "v_east", "v_north", "v_up") - run.flight.velocity(t)).norm(), 0.4);
    EXPECT_NEAR(std::stod((*row)["gps_time"]), start + t, 1e-6);
    EXPECT_EQ((*row)["strip"], "7");
    EXPECT_EQ((*row)["technique"], "pc");
    EXPECT_EQ((*row)["fixes"], "10");
    EXPECT_EQ((*row)["flags"], "");
    for (const char* sigma : {"sigma_east", "sigma_up", "sigma_north", "sigma_v_east"}) {
      EXPECT_GT(std::stod((*row)[sigma]), 0.005) << sigma;
      EXPECT_LT(std::stod((*row)[sigma]), 0.6) << sigma;
    }
  }
  EXPECT_EQ(rows[0]["id"], "A1");
  EXPECT_NEAR(std::stod(rows[0]["sigma_time"]), 0.06, 0.002);  // 1 ms at 60 m/s
  EXPECT_EQ(rows[1]["sigma_time"], "");
  const core::Value json = io::read_value_file(run.folder / "kinematic.json");
  EXPECT_EQ(json.find("events_with_position")->as_int(), 2);
  EXPECT_EQ(json.find("leave_one_out")->find("fixes")->as_int(), 50);
  EXPECT_NEAR(json.find("median_sigma_m")->items()[2].as_number(), std::max(std::stod(rows[0]["sigma_up"]), std::stod(rows[1]["sigma_up"])),
              1e-4);  // of an even number the upper of the two
  EXPECT_GT(json.find("motion")->find("median_acceleration_m_s2")->items()[0].as_number(), 0.05);
  EXPECT_EQ(rows[0].count("empirical_up"), 0u);  // one sigma
  EXPECT_EQ(io::to_json(json), io::to_json(run.findings));
  EXPECT_EQ(test::entries(run.folder.path()), 2u);
  EXPECT_TRUE(run.tally.empty());
}

TEST(KinematicStage, EventsWithoutFixesAroundThemAreFlaggedAndCounted) {
  Trial run;
  const auto drop = [](auto& column) { column.erase(column.begin() + 30, column.begin() + 40); };
  drop(run.gnss.time), drop(run.gnss.position), drop(run.gnss.covariance);
  for (const auto& [t, id] : {std::pair{-3.0, "outside"}, {0.5, "end"}, {2.5, "short"}, {20.5, "good"}, {35.0, "gap"}})
    run.event(t, id, 0.0, std::string(id) == "gap" || std::string(id) == "good");
  run.go();
  auto rows = run.rows();
  const char* flags[] = {"outside_gnss", "too_few_fixes", "short_window", "doubtful_time", "gnss_gap;doubtful_time"};
  for (size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(rows[k]["flags"], flags[k]);
    EXPECT_EQ(rows[k]["easting"].empty(), k != 2 && k != 3) << k;
    EXPECT_EQ(rows[k]["sigma_east"].empty(), k != 2 && k != 3) << k;
  }
  EXPECT_EQ(run.tally.of("events in a gap of the GNSS record, without position"), 1u);
  EXPECT_EQ(run.tally.of("events outside the GNSS record, without position"), 1u);
  EXPECT_EQ(run.tally.of("events too close to a gap or an end of the GNSS record, without position"), 1u);
  EXPECT_EQ(run.tally.of("events near a gap or an end of the GNSS record: short window"), 1u);
  EXPECT_EQ(run.tally.of("events whose time is doubtful"), 2u);
  EXPECT_EQ(run.findings.find("gaps")->as_int(), 1);
}

TEST(KinematicStage, TheLeaveOneOutTestIsWrittenAndDrawn) {
  Trial run;
  run.event(20.4, "1");
  run.set(R"({"leave_one_out": true, "file": "stations.csv"})");
  run.go();
  for (const std::string& file : run.stage->products()) EXPECT_TRUE(std::filesystem::exists(run.folder / file)) << file;
  EXPECT_EQ(run.rows("stations.csv").size(), 1u);
  const std::string table = test::read_bytes(run.folder / "leave_one_out.txt");
  for (const char* word : {"Kalman", "straight line", "2nd degree", "RTS", "50 fixes", "ratio", "straight 1"})
    EXPECT_NE(table.find(word), std::string::npos) << word;
  EXPECT_GT(io::read_png(run.folder / "leave_one_out.png").width, 500);
  EXPECT_NE(test::read_bytes(run.folder / "leave_one_out.svg").find("<svg"), std::string::npos);
}

TEST(KinematicStage, TheMethodIsAChoice) {
  std::vector<std::string> x;
  for (const char* method : {"kalman", "line", "parabola", "rts"}) {
    Trial run;
    run.event(20.4, "1");
    run.set(std::string(R"({"method": ")") + method + "\"}");
    run.go();
    x.push_back(run.rows()[0]["x"] + run.rows()[0]["y"]);
    EXPECT_EQ(run.findings.find("method")->as_text(), method);
  }
  for (size_t i = 0; i < x.size(); ++i)
    for (size_t j = 0; j < i; ++j) EXPECT_NE(x[i], x[j]);
}

TEST(KinematicStage, CoordinatesAreInUnitsOfTheCrs) {
  // UTM zone 32 in US survey feet; heights too, where the CRS leaves them open and the survey's products are in feet.
  constexpr double foot = 1200.0 / 3937.0;
  Trial metres;
  Trial feet("+proj=utm +zone=32 +datum=WGS84 +units=us-ft +type=crs");
  feet.context.vertical_unit = foot;
  for (Trial* run : {&metres, &feet}) {
    run->event(20.4, "1");
    run->go();
  }
  auto m = metres.rows()[0], f = feet.rows()[0];
  for (const char* axis : {"easting", "northing", "height"}) EXPECT_NEAR(std::stod(f[axis]) * foot, std::stod(m[axis]), 2e-4) << axis;
  EXPECT_EQ(f["x"], m["x"]);
  EXPECT_EQ(f["sigma_east"], m["sigma_east"]);
}

TEST(KinematicStage, FixesOfNoUseAreLeftOutAndTold) {
  Trial run;
  run.event(20.4, "1");
  run.gnss.covariance[40].setZero();
  run.gnss.position[50].setConstant(std::nan(""));
  run.go();
  EXPECT_EQ(run.tally.of("GNSS fixes without a position or a covariance, left out"), 2u);
  EXPECT_EQ(run.findings.find("fixes")->as_int(), 58);
}

TEST(KinematicStage, NamesThatNeedQuotesHaveThem) {
  Trial run;
  run.event(20.4, "frame 3, \"left\"");
  run.go();
  EXPECT_NE(test::read_bytes(run.folder / "events.csv").find("\n\"frame 3, \"\"left\"\"\",7,pc,"), std::string::npos);
}

TEST(KinematicStage, TimesOfAnotherScaleAndTooFewFixesAreErrors) {
  Trial run;
  run.event(20.4 + 1e5, "1");
  try {
    run.go();
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("the only event lies outside the GNSS record"), std::string::npos) << e.what();
    EXPECT_NE(e.hint().find("time scale"), std::string::npos);
  }
  EXPECT_EQ(test::entries(run.folder.path()), 0u);
  Trial few;
  few.event(0.5, "1");
  for (size_t i = 2; i < few.gnss.size(); ++i) few.gnss.covariance[i].setZero();
  EXPECT_THROW(few.go(), core::Error);
}

TEST(KinematicStage, ATechniqueADayAwayIsNamed) {
  Trial run;
  run.event(20.4, "1");
  run.event(20.4 + 86400, "1");
  run.events.technique.back() = "camera";
  run.go();
  EXPECT_EQ(run.tally.of("events outside the GNSS record, without position"), 1u);
  const core::Value* outside = run.findings.find("outside");
  ASSERT_NE(outside, nullptr);
  ASSERT_EQ(outside->items().size(), 1u);
  const std::string& sentence = outside->items()[0].find("sentence")->as_text();
  EXPECT_NE(sentence.find("the only event of 'camera' lies outside the GNSS record: events from 2024-05-18T16:53:22"), std::string::npos)
      << sentence;
  EXPECT_NE(sentence.find("1 day apart"), std::string::npos) << sentence;
}

TEST(KinematicStage, ARecordTooShortForTheTestHasASigmaToo) {
  Trial run;
  for (size_t i = 8; i < run.gnss.size(); ++i) run.gnss.covariance[i].setZero();
  run.event(3.5, "1");
  run.set(R"({"leave_one_out": true})");
  run.go();
  auto row = run.rows()[0];
  EXPECT_EQ(row["flags"], "short_window");
  EXPECT_FALSE(row["sigma_east"].empty());
  EXPECT_EQ(run.findings.find("leave_one_out")->find("fixes")->as_int(), 0);
  EXPECT_TRUE(std::filesystem::exists(run.folder / "leave_one_out.png"));
}

TEST(KinematicStage, WithoutEventsTheFixesAreTested) {
  Trial run;
  run.context.crs = core::Crs();  // no table, no CRS
  run.set(R"({"leave_one_out": true, "rates": [0.5, 2, 0.01]})");
  run.survey.lines.resize(2);
  run.survey.line_time = {core::TimeScale::gps, 0, {}};
  for (int k = 0; k < 2; ++k) {
    run.survey.lines[static_cast<size_t>(k)].id = k + 1;
    run.survey.lines[static_cast<size_t>(k)].start = core::Seconds(start + 5 + 25 * k);
    run.survey.lines[static_cast<size_t>(k)].end = core::Seconds(start + 25 + 25 * k);
  }
  run.context.records.put(run.gnss);
  run.stage->check(run.context);
  run.stage->run_survey(run.context, run.tally, run.findings);
  EXPECT_FALSE(std::filesystem::exists(run.folder / "events.csv"));
  const std::string table = test::read_bytes(run.folder / "leave_one_out.txt");
  for (const char* word : {"line 1", "line 2", "turns"}) EXPECT_NE(table.find(word), std::string::npos) << word;
  EXPECT_NE(test::read_bytes(run.folder / "rates.txt").find("0.5 Hz"), std::string::npos);
  ASSERT_EQ(run.findings.find("rates")->items().size(), 1u);
  EXPECT_EQ(run.findings.find("rates")->items()[0].find("withheld")->as_int(), 21);  // fixes 9 to 49, every second
  EXPECT_EQ(run.tally.of("rates above that of the record, not tested"), 1u);
  EXPECT_EQ(run.tally.of("rates that leave too few fixes, not tested"), 1u);
}

TEST(KinematicStage, WithNothingToDoItIsRefused) {
  Trial run;
  try {
    run.stage->check(run.context);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("no [[event]] file and no test"), std::string::npos) << e.what();
  }
}

TEST(KinematicStage, NoEventsGiveATableWithoutRows) {
  Trial run;
  run.go();
  EXPECT_TRUE(run.rows().empty());
  EXPECT_EQ(run.findings.find("events_with_position")->as_int(), 0);
}

}  // namespace
}  // namespace swath::stages
