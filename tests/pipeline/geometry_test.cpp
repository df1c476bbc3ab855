// SPDX-License-Identifier: GPL-3.0-or-later
// Mistakes of a user in a given trajectory's survey, as a run reports them.
#include <gtest/gtest.h>

#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

#include "core/error.h"
#include "io/text/output_file.h"
#include "io/text/text_table.h"
#include "io/text/value_file.h"
#include "io/vector/point_layer.h"
#include "pipeline/run.h"
#include "simulate/simulate.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

class Geometry : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    simulate::Options o = simulate::preset(simulate::Scene::town);
    o.world.length.value = 400;
    o.world.width.value = 350;
    o.flight.lines = 2;
    o.flight.cross_lines = 1;
    o.scanner.prf.value = 20000;
    o.control.targets = 4;
    simulate::run(o, folder_->path());
  }
  static void TearDownTestSuite() { folder_.reset(); }

  /// Runs configs/georeference.toml with `from` in survey.toml replaced.
  static Outcome run_with(const std::string& from, const std::string& to, std::vector<std::string> sets = {},
                          const fs::path& config = test::source_folder() / "configs/georeference.toml") {
    std::string text = test::read_bytes(folder_->path() / "survey.toml");
    if (!from.empty()) {
      const size_t at = text.find(from);
      if (at == std::string::npos) throw std::runtime_error("no " + from);
      text.replace(at, from.size(), to);
    }
    io::write_text_file(folder_->path() / "changed.toml", text);
    const test::TemporaryFolder out;
    Request r;
    r.config = config;
    r.survey = folder_->path() / "changed.toml";
    r.output = out / "out";
    r.sets = std::move(sets);
    r.threads = 2;
    Plan plan = make_plan(r);
    Progress progress(Voice::quiet);
    return run(plan, progress, "test");
  }
  /// configs/georeference.toml with the lines adjusted where needed.
  static fs::path adjusting() {
    std::string text = test::read_bytes(test::source_folder() / "configs/georeference.toml");
    const std::string before = "[[stage]]\ntype = \"georeference\"";
    const size_t at = text.find(before);
    if (at == std::string::npos) throw std::runtime_error("no georeference");
    text.insert(at, "[[stage]]\ntype = \"calib.strips\"\nwhen = \"needed\"\n\n");
    io::write_text_file(folder_->path() / "adjusting.toml", text);
    return folder_->path() / "adjusting.toml";
  }
  static const fs::path& folder() { return folder_->path(); }
  static std::string named(const Outcome& o) {
    const core::Value& names = *o.report.find("geometry")->find("named");
    return names.items().empty() ? "" : names.items().front().as_text();
  }
  static std::string verdict(const Outcome& o) { return o.report.find("geometry")->find("verdict")->as_text(); }

 private:
  static std::unique_ptr<test::TemporaryFolder> folder_;
};
std::unique_ptr<test::TemporaryFolder> Geometry::folder_;

TEST_F(Geometry, ARightSurveyIsConsistent) {
  const Outcome o = run_with("", "", {"run.limits.contradictions=0", "run.limits.line_difference=\"20 cm\""});
  EXPECT_EQ(verdict(o), "consistent");
  EXPECT_EQ(named(o), "");
  EXPECT_TRUE(o.report.find("geometry")->find("warnings")->items().empty());
  EXPECT_EQ(o.code, core::Exit::done);
}

TEST_F(Geometry, AnglesToPortAreNamedAndTheLimitIsMissed) {
  const Outcome o = run_with("angle_unit = \"deg\"", "angle_unit = \"deg\"\nangle_to_port = true", {"run.limits.contradictions=0"});
  EXPECT_EQ(verdict(o), "inconsistent");
  EXPECT_EQ(named(o), "scan_angle_sign");
  EXPECT_EQ(o.code, core::Exit::quality_missed);
}

TEST_F(Geometry, AnotherUnitOfAnglesIsNamed) {
  EXPECT_EQ(named(run_with("angle_unit = \"deg\"", "angle_unit = \"gon\"")), "scan_angle_gon");
}

TEST_F(Geometry, LateTimesAreNamed) {
  const Outcome o = run_with("latency = \"0 s\"", "latency = \"0.2 s\"");
  EXPECT_EQ(verdict(o), "inconsistent");
  EXPECT_EQ(named(o), "time_offset");
}

/// What calib.strips found.
const core::Value& strips_of(const Outcome& o) {
  for (const core::Value& stage : o.report.find("stages")->items())
    if (stage.find("type")->as_text() == "calib.strips") return *stage.find("findings");
  throw std::runtime_error("no calib.strips");
}

TEST_F(Geometry, AFlightThatDoesNotFitAnyBudgetButTheDefaultIsRefused) {
  const auto with = [](const std::string& when) {
    return run_with("", "", {"calib.strips.corrections.spacing=\"2 ms\"", "calib.strips.tolerance=\"10 m\"", "run.memory=\"1.9 GB\"", when},
                    adjusting());
  };
  EXPECT_EQ(with("calib.strips.when=needed").code, core::Exit::done) << "what is not adjusted takes nothing";
  try {
    with("calib.strips.when=always");
    ADD_FAILURE() << "adjusted";
  } catch (const core::SystemError& e) {
    EXPECT_NE(std::string(e.what()).find("calib.strips needs "), std::string::npos) << e.what();
  }
}

TEST_F(Geometry, HeightsAreNotJudgedByRoofs) {
  // 5 m too high: what the ground beside a roof looks like from its centre.
  std::istringstream lines(test::read_bytes(folder() / "control.csv"));
  std::string out, line;
  for (size_t n = 0; std::getline(lines, line); ++n) {
    size_t z = 0;
    for (int commas = 0; commas < 4; ++commas) z = line.find(',', z) + 1;
    const size_t end = line.find(',', z);
    out += n == 0 ? line : line.substr(0, z) + std::to_string(std::stod(line.substr(z, end - z)) + 5) + line.substr(end);
    out += "\n";
  }
  io::write_text_file(folder() / "high.csv", out);
  const Outcome o = run_with("file = \"control.csv\"", "file = \"high.csv\"");
  EXPECT_EQ(verdict(o), "consistent");
  EXPECT_EQ(o.report.find("geometry")->find("control"), nullptr);
}

TEST(PoorGnss, ErrorsThatTheSigmasAllowAreNotAMistake) {
  const test::TemporaryFolder folder;
  simulate::Options o;
  o.seed = 1;
  o.world.length.value = 200;
  o.world.width.value = 200;
  o.flight.lines = 3;
  o.flight.cross_lines = 1;
  o.gnss.sigma_horizontal.value = 1.5;
  o.gnss.sigma_vertical.value = 3;
  simulate::run(o, folder.path());
  std::string text = test::read_bytes(test::source_folder() / "configs/survey.toml");
  const size_t behind = text.find("[[stage]]", text.find("quality.geometry"));
  ASSERT_NE(behind, std::string::npos);
  io::write_text_file(folder.path() / "gate.toml", text.substr(0, behind));
  Request r;
  r.config = folder.path() / "gate.toml";
  r.survey = folder.path() / "survey.toml";
  r.output = folder.path() / "out";
  r.threads = 2;
  Plan plan = make_plan(r);
  Progress progress(Voice::quiet);
  const Outcome found = run(plan, progress, "test");
  const core::Value& geometry = *found.report.find("geometry");
  EXPECT_EQ(geometry.find("verdict")->as_text(), "consistent");
  EXPECT_TRUE(geometry.find("named")->items().empty());
}

TEST(GroundControl, HeightsOfAGeoPackageCountFromWhatItsOwnCrsSays) {
  const test::TemporaryFolder folder;
  simulate::Options o;
  o.world.length.value = 200;
  o.world.width.value = 200;
  o.flight.lines = 3;
  o.flight.cross_lines = 1;
  o.control.points = 8;
  simulate::run(o, folder.path());
  // Ellipsoidal heights, as the simulation has them, in a file that states EGM96.
  const io::TextTable table(folder / "check.csv");
  std::vector<io::NamedPoint> points;
  for (size_t r = 0; r < table.rows(); ++r) {
    const auto at = [&](const char* column) { return table.number(r, table.column(column)); };
    points.push_back({table.text(r, table.column("name")), "", {at("x"), at("y"), at("z")}, {}});
  }
  io::write_point_layer(folder / "check.gpkg", "check", "EPSG:32632+5773", {}, points);
  std::string survey = test::read_bytes(folder / "survey.toml");
  survey.replace(survey.find("check.csv"), 9, "check.gpkg");
  io::write_text_file(folder / "survey.toml", survey);
  std::string gate = test::read_bytes(test::source_folder() / "configs/survey.toml");
  io::write_text_file(folder / "gate.toml", gate.substr(0, gate.find("[[stage]]", gate.find("quality.geometry"))));
  Request r;
  r.config = folder / "gate.toml";
  r.survey = folder / "survey.toml";
  r.output = folder / "out";
  r.threads = 2;
  Plan plan = make_plan(r);
  Progress progress(Voice::quiet);
  const std::string report = io::to_json(run(plan, progress, "test").report);
  EXPECT_NE(report.find("with the control's heights ellipsoidal, or the trajectory's above the geoid"), std::string::npos) << report;
}

TEST_F(Geometry, AUsualMistakeIsNotHiddenByAnAdjustment) {
  const Outcome o = run_with("angle_unit = \"deg\"", "angle_unit = \"gon\"", {}, adjusting());
  EXPECT_EQ(named(o), "scan_angle_gon");
  EXPECT_FALSE(strips_of(o).find("adjusted")->as_bool());
  EXPECT_NE(strips_of(o).find("reason")->as_text().find("gon"), std::string::npos) << strips_of(o).find("reason")->as_text();
}

TEST_F(Geometry, LinesThatAFittedValueExplainsAreAdjusted) {
  const Outcome o = run_with("latency = \"0 s\"", "latency = \"0.02 s\"", {}, adjusting());
  EXPECT_EQ(named(o), "time_offset");
  EXPECT_EQ(o.report.find("geometry")->find("doubt"), nullptr);
  EXPECT_TRUE(strips_of(o).find("adjusted")->as_bool());
}

TEST_F(Geometry, AReversedScanIsRefusedBeforeAnAdjustment) {
  try {
    run_with("angle_unit = \"deg\"", "angle_unit = \"deg\"\nangle_to_port = true", {}, adjusting());
    FAIL() << "a reversed scan";
  } catch (const core::Error& e) {
    EXPECT_EQ(e.code(), core::Exit::bad_usage);
  }
}

TEST_F(Geometry, ARefusalNamesTheMistakeThatTheGateFound) {
  try {
    run_with("angle_unit = \"deg\"", "angle_unit = \"deg\"\nrange_unit = \"100 m\"");
    FAIL() << "ranges of 40 km";
  } catch (const core::Error& e) {
    EXPECT_NE(e.hint().find("with ranges in centimetres"), std::string::npos) << e.hint();
  }
}

}  // namespace
}  // namespace swath::pipeline
