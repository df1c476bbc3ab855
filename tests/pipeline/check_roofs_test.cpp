// SPDX-License-Identifier: GPL-3.0-or-later
// quality.points in a run: surveyed roofs of a simulated survey that is moved by a known amount.
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

const std::string stages = R"([run]
tile = "80 m"
[[stage]]
type = "readers.trajectory"
[[stage]]
type = "readers.laser"
[[stage]]
type = "georeference"
[[stage]]
type = "filters.returns"
[[stage]]
type = "quality.points"
)";
constexpr double east = 0.22, north = -0.13;  // m, of the cloud against the targets

class CheckRoofs : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    simulate::Options o = simulate::preset(simulate::Scene::town);
    o.world.length.value = 300;
    o.world.width.value = 240;
    o.flight.lines = 2;
    o.scanner.prf.value = 40000;
    o.scanner.frequency.value = 45;
    o.control.targets = 10;
    o.control.points = 0;
    o.control.sigma.value = 0.01;
    o.imu.file = o.gnss.file = false;
    o.mounting.deliver = simulate::Deliver::truth;
    o.noise.horizontal.value = o.noise.vertical.value = o.noise.roll_pitch.value = o.noise.heading.value = 0.0;
    simulate::run(o, folder_->path());
    test::write_bytes(*folder_ / "roofs.toml", stages);
    std::string survey = test::read_bytes(*folder_ / "survey.toml");
    const std::string control = "file = \"control.csv\"\n";
    survey.replace(survey.find(control), control.size(), "file = \"roofs.csv\"\nuse = \"check\"\n");
    test::write_bytes(*folder_ / "check.toml", survey);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  /// The targets moved against the cloud; of the target named `of` by `more` m farther east.
  static Outcome run_with(const std::filesystem::path& output, double more = 0.0, const std::vector<std::string>& sets = {},
                          int threads = 2) {
    std::string changed;
    const auto move = [&](int k, std::vector<std::string>& cells) {
      if (k == 0) return;
      if (k == 1) changed = cells[1];
      cells[2] = std::to_string(std::stod(cells[2]) - east + (cells[1] == changed ? more : 0.0));
      cells[3] = std::to_string(std::stod(cells[3]) - north);
    };
    test::write_bytes(*folder_ / "roofs.csv", test::with_rows(test::read_bytes(*folder_ / "control.csv"), move));
    Request r;
    r.config = *folder_ / "roofs.toml";
    r.survey = *folder_ / "check.toml";
    r.output = output;
    r.sets = sets;
    r.threads = threads;
    Plan plan = make_plan(r);
    Progress progress(Voice::quiet);
    return run(plan, progress, "test");
  }
  static const core::Value& findings(const Outcome& o) {
    for (const core::Value& s : o.report.find("stages")->items())
      if (s.find("type")->as_text() == "quality.points") return *s.find("findings");
    throw std::runtime_error("no quality.points");
  }
  static std::vector<std::string> codes(const Outcome& o) {
    std::vector<std::string> out;
    for (const core::Value& w : o.report.find("warnings")->items())
      if (w.find("code")->as_text() != "control.unused") out.push_back(w.find("code")->as_text());
    return out;
  }
  static std::unique_ptr<test::TemporaryFolder> folder_;
};
std::unique_ptr<test::TemporaryFolder> CheckRoofs::folder_;

double number(const core::Value& v, const char* key) { return v.find(key)->as_number(); }

TEST_F(CheckRoofs, APutInShiftIsFound) {
  const test::TemporaryFolder out;
  const Outcome done = run_with(out / "a");
  EXPECT_TRUE(codes(done).empty());
  const core::Value& p = *findings(done).find("planimetry");
  EXPECT_GE(number(p, "roofs"), 5);
  EXPECT_LT(number(p, "sigma_east_m"), 0.03);
  EXPECT_NEAR(number(p, "east_m"), east, 4.0 * number(p, "sigma_east_m"));
  EXPECT_NEAR(number(p, "north_m"), north, 4.0 * number(p, "sigma_north_m"));
  EXPECT_NEAR(number(p, "rmse_m"), std::hypot(east, north), 0.04);
  EXPECT_NEAR(number(p, "rmse_with_targets_m"), std::hypot(number(p, "rmse_m"), number(p, "sigma_of_targets_m")), 1e-4);
  double chi = 0.0, n = 0.0;
  for (const core::Value& r : findings(done).find("roofs")->items()) {
    if (r.find("state")->as_text() != "both") continue;
    chi += std::pow((number(r, "east_m") - east) / number(r, "sigma_east_m"), 2);
    chi += std::pow((number(r, "north_m") - north) / number(r, "sigma_north_m"), 2);
    n += 2.0;
  }
  EXPECT_LT(chi / n, 3.0);
}

TEST_F(CheckRoofs, AChangedRoofIsNamed) {
  const test::TemporaryFolder out;
  const Outcome done = run_with(out / "a", 0.6);
  EXPECT_EQ(codes(done), std::vector<std::string>{"check.roof"});
  EXPECT_EQ(number(*findings(done).find("planimetry"), "changed"), 1);
  EXPECT_NEAR(number(*findings(done).find("planimetry"), "east_m"), east, 0.05);
}

TEST_F(CheckRoofs, ALimitIsMissed) {
  const test::TemporaryFolder out;
  EXPECT_EQ(run_with(out / "a", 0.0, {"run.limits.planimetry=\"0.2 m\""}).code, core::Exit::quality_missed);
  EXPECT_EQ(run_with(out / "b", 0.0, {"run.limits.planimetry=\"0.3 m\""}).code, core::Exit::done);
}

TEST_F(CheckRoofs, TilesAndThreadsChangeNothing) {
  const test::TemporaryFolder out;
  const core::Value one = *findings(run_with(out / "a")).find("roofs"),
                    other = *findings(run_with(out / "b", 0.0, {"run.tile=\"200 m\""}, 1)).find("roofs");
  ASSERT_EQ(one.items().size(), other.items().size());
  for (size_t k = 0; k < one.items().size(); ++k) {
    const core::Value &a = one.items()[k], &b = other.items()[k];
    EXPECT_EQ(a.find("state")->as_text(), b.find("state")->as_text());
    if (a.find("east_m")) {
      EXPECT_NEAR(number(a, "east_m"), number(b, "east_m"), 1e-4);
    }
  }
}

}  // namespace
}  // namespace swath::pipeline
