// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/calibration_flight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace swath::planning {
namespace {

CalibrationFlight usual() {
  CalibrationFlight f;
  f.height = 700;
  f.second_height = 1100;
  f.half_angle = 0.45;
  f.length = 1500;
  f.target_half_width = 20;
  return f;
}

TEST(CalibrationFlight, PairsAlongAcrossAtTheEdgeWithoutScanAndHigh) {
  std::set<std::string> names;
  for (const CalibrationLine& l : calibration_lines(usual())) {
    names.insert(l.name);
    EXPECT_NEAR((l.to - l.from).norm(), 1500, 1e-9);
    EXPECT_EQ(l.level, l.name.starts_with("high") ? 400 : 0);
    EXPECT_EQ(l.scans, !l.name.starts_with("profile"));
  }
  EXPECT_EQ(names, (std::set<std::string>{"along 1", "along 2", "across 1", "across 2", "edge right 1", "edge right 2", "profile 1",
                                          "profile 2", "high along 1", "high along 2", "high across 1", "high across 2"}));
}

TEST(CalibrationFlight, TheTargetStaysInTheSwath) {
  for (const CalibrationLine& l : calibration_lines(usual())) {
    const Eigen::Vector2d way = (l.to - l.from).normalized();
    const double aside = std::abs(way.x() * l.from.y() - way.y() * l.from.x());
    EXPECT_LT(aside + 20, (700 + l.level) * std::tan(0.45));
    if (l.name.starts_with("edge")) {
      EXPECT_GT(aside, 0.8 * 700 * std::tan(0.45));
    }
  }
}

TEST(CalibrationFlight, PartsThatAreLeftOut) {
  CalibrationFlight f = usual();
  f.second_height = 0;
  f.edge_lines = f.profile_lines = false;
  f.cross_lines = 0;
  EXPECT_EQ(calibration_lines(f).size(), 2u);
  f.opposite = false;
  const auto lines = calibration_lines(f);
  EXPECT_GT((lines[0].to - lines[0].from).dot(lines[1].to - lines[1].from), 0);
}

}  // namespace
}  // namespace swath::planning
