// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/rate_test.h"

#include <gtest/gtest.h>

#include "core/config/result_visitors.h"
#include "tests/trajectory/made_flight.h"

namespace swath::trajectory {
namespace {

TEST(RateTest, ThinsAndComparesWithWhatWasTakenAway) {
  const PointFixes fixes = test::MadeFlight(2).fixes(600, 5.0, 0.0);
  const RateTest one = test_rate(fixes, 1.0, {}, {}), two = test_rate(fixes, 2.0, {}, {}), all = test_rate(fixes, 5.0, {}, {});
  EXPECT_NEAR(one.leave_one_out.step, 1.0, 0.01);
  EXPECT_EQ(one.leave_one_out.fix.size() + one.leave_one_out.beside_gaps, 120u);
  EXPECT_EQ(two.leave_one_out.fix.size() + two.leave_one_out.beside_gaps, 240u);
  EXPECT_EQ(all.withheld, 0u);
  EXPECT_NEAR(static_cast<double>(one.withheld), 4 * 110.0, 8.0);
  // A lower rate bridges more motion: the straight line shows it most.
  const auto line = static_cast<size_t>(Interpolator::line);
  EXPECT_GT(one.at_those[line].rms.norm(), 2.0 * two.at_those[line].rms.norm());
  for (const RateTest* r : {&one, &two})
    for (const DifferenceStatistics& s : r->at_those)
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(s.ratio[axis], 1.0, 0.3);
  const std::string table = table_of({one, two});
  for (const char* words : {"1 Hz", "2 Hz", "taken away", "straight line"}) EXPECT_NE(table.find(words), std::string::npos) << words;
  EXPECT_EQ(core::reported(one).find("withheld")->as_int(), static_cast<std::int64_t>(one.withheld));
}

}  // namespace
}  // namespace swath::trajectory
