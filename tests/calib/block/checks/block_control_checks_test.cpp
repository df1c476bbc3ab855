// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/block_control_checks.h"

#include <gtest/gtest.h>

#include "tests/calib/block/checks/refusal.h"

namespace swath::calib {
namespace {

test::MadeFiles made() {
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  return m;
}

void expect_in(const std::string& text, const std::string& part) { EXPECT_NE(text.find(part), std::string::npos) << text; }

TEST(BlockControlChecks, FeetAndExchangedCoordinates) {
  test::MadeFiles m = made();
  m.control_unit = 0.3048;
  expect_in(test::refusal(m), "control is in feet");
  m = made();
  for (BlockControl& c : m.block.control) std::swap(c.position.x(), c.position.y());
  expect_in(test::refusal(m), "easting and northing of control are exchanged");
}

/// As where one file of several is in feet.
TEST(BlockControlChecks, SomePointsInFeet) {
  test::MadeFiles m = made();
  m.write_angles = true;
  size_t wrong = 0;
  for (BlockControl& c : m.block.control)
    if (c.known[0] && wrong < 3) c.position /= 0.3048, ++wrong;
  const std::string text = test::refusal(m);
  expect_in(text, "control is in feet: 3 of " + std::to_string(m.block.control.size()) + " points lie");
  expect_in(text, "1 ft = 0.3048 m");
}

TEST(BlockControlChecks, TwoNamesExchanged) {
  test::MadeFiles m = made();
  std::vector<size_t> full;
  for (size_t k = 0; k < m.block.control.size(); ++k)
    if (m.block.control[k].known[0]) full.push_back(k);
  ASSERT_GE(full.size(), 4u);
  BlockControl &a = m.block.control[full[0]], &b = m.block.control[full[1]];
  std::swap(a.position, b.position);
  const std::string text = test::refusal(m);
  expect_in(text, "two may be exchanged");
  expect_in(text, m.block.points[a.point].name);
  expect_in(text, m.block.points[b.point].name);
}

TEST(BlockControlChecks, PrincipalDistanceTenTimesTooSmall) {
  test::MadeFiles m = made();
  m.block.cameras[0].value[0] /= 10.0;
  expect_in(test::refusal(m), "the principal distance is ten times too small");
}

}  // namespace
}  // namespace swath::calib
