// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/leave_one_out.h"

#include <gtest/gtest.h>

#include "io/value_file.h"
#include "tests/trajectory/kinematic_vectors.h"

namespace swath::trajectory {
namespace {

TEST(LeaveOneOut, StatisticsOfTheReference) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p000_expected.json");
  const core::Value expected = io::read_value_file(file);
  for (const auto& [name, flight] : expected.find("trajectories")->members()) {
    const PointFixes fixes = test::read_fixes(file.parent_path() / flight.find("csv")->as_text());
    const PointSmoother smoother(fixes);
    for (const auto& [variant, stated] : expected.find("variants")->members()) {
      const LeaveOneOut ours = leave_one_out(fixes, smoother, test::options_of(stated));
      const core::Value& theirs = *flight.find("loo")->find(variant);
      const DifferenceStatistics& s = ours.of(Interpolator::kalman);
      printf("%s %s n %zu mean %g sigma %g max %g formal %g\n", name.c_str(), variant.c_str(), ours.fix.size(),
             (s.mean - test::vector3(*theirs.find("mean"))).norm(), (s.sigma - test::vector3(*theirs.find("sigma"))).norm(),
             (s.max_abs - test::vector3(*theirs.find("max_abs"))).norm(),
             (s.median_formal - test::vector3(*theirs.find("median_formal_sd"))).norm());
    }
    const LeaveOneOut l = leave_one_out(fixes, smoother, {});
    printf("%s\n%g %g %g\n", l.table().c_str(), l.acceleration[0], l.acceleration[1], l.acceleration[2]);
  }
}

}  // namespace
}  // namespace swath::trajectory
