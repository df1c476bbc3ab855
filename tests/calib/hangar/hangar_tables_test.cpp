// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/hangar/hangar_tables.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "core/config/units.h"
#include "tests/calib/made_hangar.h"

namespace swath::calib {
namespace {

/// The numbers of the line that begins so, behind its name.
std::vector<double> numbers_of(const std::string& text, const std::string& name) {
  const size_t at = text.find("\n" + name);
  if (at == std::string::npos) return {};
  std::istringstream in(text.substr(at + 33, text.find('\n', at + 1) - at - 33));
  std::vector<double> out;
  for (double v; in >> v;) out.push_back(v);
  return out;
}

TEST(HangarTables, StationsPointsAndArmsWithTheirSigmas) {
  test::MadeHangar made;
  made.build();
  const HangarResult r = solve_hangar(made.measure(1), false);
  const std::string text = tables_of(r, 0.1 * core::degree);
  constexpr double digit = 0.5e-3 + 1e-9;  // m, of three decimals
  for (const StationResult& s : r.stations) {
    const auto row = numbers_of(text, s.name);
    ASSERT_EQ(row.size(), 6u) << s.name << "\n" << text;
    EXPECT_NEAR(row[0], s.position.x(), digit);
    EXPECT_NEAR(row[5], std::sqrt(s.covariance(2, 2)), digit);
  }
  for (const PointResult& p : r.points) EXPECT_EQ(numbers_of(text, p.name).size(), 6u) << p.name;
  // The arm from IMU to antenna: 1.195 m up and 0.85 m back, so that 10 deg of roll move it by sin(10 deg) of its height.
  const auto level = numbers_of(text, "imu to antenna, roll 0 deg"), rolled = numbers_of(text, "imu to antenna, roll 10 deg");
  ASSERT_EQ(rolled.size(), 6u) << text;
  EXPECT_EQ(level[0] + level[1] + level[2], 0.0);
  EXPECT_NEAR(rolled[1], 1.195 * std::sin(10 * core::degree) + 0.26 * (std::cos(10 * core::degree) - 1), 0.01);
  EXPECT_GE(rolled[4], level[3]);
  EXPECT_EQ(numbers_of(text, "imu to antenna, pitch 5 deg").size(), 6u);
  // A tilt that is known exactly leaves the arm's own sigma.
  EXPECT_LT(numbers_of(tables_of(r, 0.0), "imu to antenna, roll 0 deg")[4], level[4] + digit);
}

}  // namespace
}  // namespace swath::calib
