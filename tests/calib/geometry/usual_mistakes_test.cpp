// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/usual_mistakes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace swath::calib {
namespace {

size_t count(const std::vector<UsualMistake>& all, std::string_view name) {
  return static_cast<size_t>(std::count_if(all.begin(), all.end(), [&](const UsualMistake& m) { return m.name == name; }));
}

Chain stated() {
  Chain c;
  c.calibration.roll = core::degrees(0.1);
  c.calibration.lever_arm_scanner = {core::Metres(0.2), core::Metres(0.1), core::Metres(0.3)};
  return c;
}

TEST(UsualMistakes, EachChangesOneSideAndSaysWhatToDo) {
  for (const UsualMistake& m : usual_mistakes(stated(), 0.02)) {
    EXPECT_NE(static_cast<bool>(m.chain), static_cast<bool>(m.trajectory)) << m.name;
    EXPECT_TRUE(m.what.starts_with("with ")) << m.name;
    EXPECT_FALSE(m.cure.empty()) << m.name;
  }
}

TEST(UsualMistakes, WhatChangesNothingIsNotTried) {
  const auto all = usual_mistakes(stated(), 0.0);
  EXPECT_EQ(count(all, "heading_grid_north"), 0u);
  EXPECT_EQ(count(all, "boresight_roll_sign"), 1u);
  EXPECT_EQ(count(all, "boresight_pitch_sign"), 0u);
  EXPECT_EQ(count(all, "lever_arm_millimetres"), 0u);
  Chain far = stated();
  far.calibration.lever_arm_scanner[0] = core::Metres(200);
  EXPECT_EQ(count(usual_mistakes(far, 0.0), "lever_arm_millimetres"), 2u);
  EXPECT_EQ(count(usual_mistakes(Chain{}, 0.0), "boresight_sign"), 0u);
}

TEST(UsualMistakes, ModelsOfOneFormAreOne) {
  for (const core::ScannerModel m : {core::ScannerModel::mirror, core::ScannerModel::polygon, core::ScannerModel::beam}) {
    Chain c;
    c.scanner.model = m;
    EXPECT_EQ(count(usual_mistakes(c, 0.0), "scanner_model"), 3u);
  }
}

TEST(UsualMistakes, TheSignOfRollIsTurned) {
  core::TrajectoryData d;
  d.roll = {0.1, -0.2};
  for (const UsualMistake& m : usual_mistakes(stated(), 0.0))
    if (m.name == "roll_sign") m.trajectory(d);
  EXPECT_EQ(d.roll, (std::vector<double>{-0.1, 0.2}));
}

}  // namespace
}  // namespace swath::calib
