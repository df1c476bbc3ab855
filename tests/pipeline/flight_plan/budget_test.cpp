// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/flight_plan/budget.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "simulate/simulate.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

/// The inputs of Brandalize's table 10 as a survey's own sigmas: its column of 20 deg at 750 m, from roll, pitch, heading, scan angle and
/// range.
TEST(Budget, TheSurveysOwnSigmas) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "survey.toml", R"(
name = "a"
crs = "EPSG:32632"
[sigma]
roll = "0.03 deg"
pitch = "0.03 deg"
heading = "0.04 deg"
scan_angle = "0.02 deg"
range = "5 cm"
lever_arm = "8 cm"
[[points]]
file = "a.las"
)");
  test::write_bytes(folder / "a.las", "LASF");
  const BudgetTable t = budget_of({folder / "survey.toml", 750, {0.0, 20 * core::degree}, 60, 0.1, 0.3});
  ASSERT_EQ(t.budget.size(), 2u);
  EXPECT_EQ(t.budget[1].rows[0].source, "roll");
  // Trajectory without a file: 2 cm, 3 cm, 0.0025 and 0.005 deg beside the survey's own.
  const double roll = std::hypot(0.03, 0.0025) * core::degree;
  EXPECT_NEAR(t.budget[1].rows[0].error.y(), 750 * roll, 1e-4);
  EXPECT_NEAR(t.budget[1].rows[0].error.z(), 750 * std::tan(20 * core::degree) * roll, 1e-4);
  EXPECT_NEAR(t.budget[1].rows[2].error.x(), 750 * std::tan(20 * core::degree) * std::hypot(0.04, 0.005) * core::degree, 1e-4);
  EXPECT_NEAR(t.budget[0].rows[4].error.z(), 0.05, 1e-6);
  EXPECT_GT(t.surface[1].surface, t.surface[1].vertical);
  EXPECT_NEAR(*t.forest, 0.10 + 0.12, 1e-9);
  EXPECT_NE(budget_text(t).find("usual values"), std::string::npos);
  EXPECT_THROW(budget_of({folder / "survey.toml", 750, {0.0}, 60, 0.1, 0.2}), core::Error);
  EXPECT_THROW(budget_of({folder / "survey.toml", 0, {0.0}, 60, 0.1, {}}), core::Error);
  EXPECT_THROW(budget_of({folder / "survey.toml", 750, {1.5}, 60, 0.1, {}}), core::Error);
}

/// Sigmas of a trajectory are read from its file.
TEST(Budget, TheTrajectorysOwnSigmas) {
  const test::TemporaryFolder folder;
  simulate::Options o = simulate::preset(simulate::Scene::flat);
  o.noise.roll_pitch = core::degrees(0.02);
  o.imu.file = o.gnss.file = false;
  simulate::run(o, folder.path());
  const BudgetTable t = budget_of({folder / "survey.toml", 500, {0.0}, 60, 0.0, {}});
  EXPECT_NE(t.trajectory.find("states"), std::string::npos);
  EXPECT_NEAR(t.budget[0].rows[1].error.x(), 500 * std::hypot(0.02, 0.002) * core::degree, 0.03 * t.budget[0].rows[1].error.x());
}

}  // namespace
}  // namespace swath::pipeline
