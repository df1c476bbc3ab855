// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/flight_design.h"

#include <gtest/gtest.h>

#include "core/config/units.h"

namespace swath::calib {
namespace {

TEST(FlightDesign, LinesThatSharePlanesAndTheAngleBetweenThem) {
  CalibrationReport r;
  for (const int id : {1, 2, 3}) {
    r.ties.lines.push_back({id, 0.0, 1.0});
    r.lines.push_back({id, "", id == 2 ? 350 * core::degree : 10 * core::degree, 0.0, 0.0, 0.0, 0.0, 1.0, 0});
  }
  r.ties.planes.resize(2);
  r.ties.planes[1].kind = TieKind::target;
  r.ties.planes[1].control.resize(4);
  r.ties.groups = {{0, 0, 0, 0}, {0, 1, 0, 0}, {1, 0, 0, 0}, {1, 1, 0, 0}};
  const FlightDesign d = flight_design(r);
  ASSERT_EQ(d.lines.size(), 3u);
  EXPECT_EQ(d.lines[0].planes, 2u);
  EXPECT_EQ(d.lines[2].planes, 0u);
  ASSERT_EQ(d.pairs.size(), 1u) << "line 3 shares nothing";
  EXPECT_EQ(d.pairs[0].lines, (std::array<int, 2>{1, 2}));
  EXPECT_EQ(d.pairs[0].planes, 2u);
  EXPECT_NEAR(d.pairs[0].turn, 20 * core::degree, 1e-12);
  EXPECT_EQ(d.planes.front().second.surveyed, 0u);
  EXPECT_EQ(d.planes.back().first, "target");
  EXPECT_EQ(d.planes.back().second.surveyed, 1u);
}

}  // namespace
}  // namespace swath::calib
