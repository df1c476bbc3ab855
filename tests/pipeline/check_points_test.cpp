// SPDX-License-Identifier: GPL-3.0-or-later
// quality.points in a run: check points of a simulated survey, right ones and wrong ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "io/text/value_file.h"
#include "pipeline/run.h"
#include "simulate/simulate.h"
#include "tests/world/csv_rows.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

const std::string stages = R"(
[[stage]]
type = "readers.trajectory"
[[stage]]
type = "readers.laser"
[[stage]]
type = "georeference"
[[stage]]
type = "filters.returns"
[[stage]]
type = "filters.smrf"
[[stage]]
type = "terrain.dtm"
cell = "1 m"
[[stage]]
type = "quality.points"
)";

class CheckPoints : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    simulate::Options o = simulate::preset(simulate::Scene::flat);
    o.world.length.value = 300;
    o.world.width.value = 200;
    o.flight.lines = 2;
    o.scanner.prf.value = 12000;
    o.control.points = 32;
    o.imu.file = o.gnss.file = false;
    simulate::run(o, folder_->path());
    test::write_bytes(*folder_ / "points.toml", stages);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  /// check.csv with `by` metres added to the heights of the rows that `which` names (from 1; 0: all), and a cover.
  static Outcome run_with(int which, double by, const std::filesystem::path& output, const std::string& trees = "forest",
                          const std::string& open = "open") {
    const std::string good = test::read_bytes(*folder_ / "check.csv");
    size_t z = 0;
    test::write_bytes(*folder_ / "check.csv", test::with_rows(good, [&](int k, std::vector<std::string>& cells) {
      if (k == 0)
        z = static_cast<size_t>(std::find(cells.begin(), cells.end(), "z") - cells.begin());
      else if (which == 0 || which == k)
        cells[z] = std::to_string(std::stod(cells[z]) + by);
      cells.push_back(k == 0 ? "cover" : k % 4 == 0 ? trees : open);
    }));
    Request r;
    r.config = *folder_ / "points.toml";
    r.survey = *folder_ / "survey.toml";
    r.output = output;
    r.threads = 2;
    Plan plan = make_plan(r);
    Progress progress(Voice::quiet);
    Outcome done = run(plan, progress, "test");
    test::write_bytes(*folder_ / "check.csv", good);
    return done;
  }
  static const core::Value& findings(const Outcome& o) {
    for (const core::Value& s : o.report.find("stages")->items())
      if (s.find("type")->as_text() == "quality.points") return *s.find("findings");
    throw std::runtime_error("no quality.points");
  }
  static std::vector<std::string> codes(const Outcome& o) {
    std::vector<std::string> out;
    for (const core::Value& w : o.report.find("warnings")->items())
      if (w.find("code")->as_text().starts_with("check.")) out.push_back(w.find("code")->as_text());
    return out;
  }
  static std::unique_ptr<test::TemporaryFolder> folder_;
};
std::unique_ptr<test::TemporaryFolder> CheckPoints::folder_;

TEST_F(CheckPoints, RightOnesAreJudgedByCoverAndNoneIsNamed) {
  const test::TemporaryFolder out;
  const Outcome done = run_with(0, 0.0, out / "a");
  const core::Value& f = findings(done);
  EXPECT_EQ(f.find("marks")->as_int(), 32);
  EXPECT_TRUE(codes(done).empty());
  std::int64_t open = 0, vegetated = 0, models = 0;
  for (const core::Value& a : f.find("accuracy")->items()) {
    const double rms = a.find("rms")->as_number(), marks = a.find("sigma_of_marks_m")->as_number();
    EXPECT_NEAR(a.find("rmse_with_marks_m")->as_number(), std::hypot(rms, marks), 1e-9);
    EXPECT_LT(rms, 0.12);
    if (a.find("product")->as_text() == "dtm") {
      ++models;
      continue;
    }
    if (a.find("cover")->as_text() == "open (NVA)") open = a.find("n")->as_int();
    if (a.find("cover")->as_text() == "vegetated (VVA)") vegetated = a.find("n")->as_int();
  }
  EXPECT_EQ(open + vegetated + (f.find("unread") ? static_cast<std::int64_t>(f.find("unread")->items().size()) : 0), 32);
  EXPECT_GT(vegetated, 3);
  EXPECT_EQ(models, 5);  // open, vegetated, all, and each cover by its name
  const std::string table = test::read_bytes(out / "a/check_points.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 33);
}

TEST_F(CheckPoints, CoversAreKnownInOtherLanguagesAndUnknownOnesNamed) {
  const test::TemporaryFolder out;
  const auto open_of = [](const Outcome& o) {
    for (const core::Value& a : findings(o).find("accuracy")->items())
      if (a.find("product")->as_text() == "points" && a.find("cover")->as_text() == "open (NVA)") return a.find("n")->as_int();
    return std::int64_t{0};
  };
  const Outcome english = run_with(0, 0.0, out / "a"), german = run_with(0, 0.0, out / "b", "Wald", "Offen");
  EXPECT_TRUE(codes(german).empty());
  EXPECT_EQ(open_of(german), open_of(english));
  const Outcome unknown = run_with(0, 0.0, out / "c", "B17", "sol nu");
  EXPECT_EQ(open_of(unknown), open_of(english));
  ASSERT_EQ(codes(unknown), std::vector<std::string>{"check.cover"});
  const std::string sentence = findings(unknown).find("named")->items()[0].find("sentence")->as_text();
  EXPECT_NE(sentence.find("8 check points have covers"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("'B17' ("), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("check.csv"), std::string::npos) << sentence;
}

TEST_F(CheckPoints, ABadOneAndAWrongGeoidAreNamed) {
  const test::TemporaryFolder out;
  EXPECT_EQ(codes(run_with(7, 0.5, out / "a")), std::vector<std::string>{"check.mark"});
  EXPECT_EQ(codes(run_with(0, 46.8, out / "b")), std::vector<std::string>{"check.heights"});
}

TEST_F(CheckPoints, HeightsInFeetAreThoseOfTheSurvey) {
  const test::TemporaryFolder out;
  const std::string survey = test::read_bytes(*folder_ / "survey.toml");
  test::write_bytes(*folder_ / "survey.toml", "height_unit = \"1 ft\"\n" + survey);
  const std::string good = test::read_bytes(*folder_ / "check.csv");
  size_t z = 0;
  test::write_bytes(*folder_ / "check.csv", test::with_rows(good, [&](int k, std::vector<std::string>& cells) {
    if (k == 0)
      z = static_cast<size_t>(std::find(cells.begin(), cells.end(), "z") - cells.begin());
    else
      cells[z] = std::to_string(std::stod(cells[z]) / 0.3048);
  }));
  const Outcome done = run_with(0, 0.0, out / "a");
  test::write_bytes(*folder_ / "check.csv", good);
  test::write_bytes(*folder_ / "survey.toml", survey);
  const std::string table = test::read_bytes(out / "a/check_points.csv");
  EXPECT_NE(table.find(",unit,height_unit,difference_unit\n"), std::string::npos) << table.substr(0, 200);
  EXPECT_NE(table.find(",m,ft,m\n"), std::string::npos);
  EXPECT_TRUE(codes(done).empty());
  for (const core::Value& a : findings(done).find("accuracy")->items()) EXPECT_LT(a.find("rms")->as_number(), 0.12);
}

}  // namespace
}  // namespace swath::pipeline
