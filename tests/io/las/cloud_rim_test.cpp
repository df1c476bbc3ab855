// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/cloud_rim.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/grid.h"

namespace swath::io {
namespace {

core::Block points(const Eigen::Vector3d& origin, std::initializer_list<std::pair<double, double>> places) {
  core::Block b;
  b.origin = origin;
  for (const auto& [x, y] : places) {
    b.x.push_back(x - origin.x());
    b.y.push_back(y - origin.y());
    b.z.push_back(5.0);
  }
  return b;
}

TEST(CloudRim, PointsOnTheRimFallIntoTheLastCell) {
  for (const double step : {0.01, 0.001, 0.0001, 1e-7}) {
    const double x = 501000.0, y = 5301000.0;
    core::Block b = points({500000.0, 5300000.0, 0.0}, {{x, y - 300.0}, {x - step, y}, {x - 1.0, y - 1.0}, {500000.0, 5300000.0}});
    const core::Block before = b;
    keep_rim_inside(b, {x, y}, {step, step});
    EXPECT_EQ(core::cell_index(b.origin.x() + b.x[0], 1.0), 500999) << step;
    EXPECT_EQ(core::cell_index(b.origin.y() + b.y[1], 1.0), 5300999) << step;
    for (size_t p = 0; p < b.size(); ++p) {
      EXPECT_NEAR(b.x[p], before.x[p], std::max(0.002 * step, 1e-8)) << p;
      // The file's whole numbers stay as they are.
      if (step > 1e-6) {
        EXPECT_EQ(std::llround((b.origin.x() + b.x[p]) / step), std::llround((before.origin.x() + before.x[p]) / step));
      }
    }
    for (const size_t inside : {2u, 3u}) {
      EXPECT_EQ(b.x[inside], before.x[inside]);
      EXPECT_EQ(b.y[inside], before.y[inside]);
    }
  }
}

TEST(CloudRim, PointsBeyondAWrongRimStay) {
  core::Block b = points({0.0, 0.0, 0.0}, {{100.0, 100.0}, {103.0, 50.0}});
  keep_rim_inside(b, {100.0, 90.0}, {0.01, 0.01});
  EXPECT_LT(b.x[0], 100.0);
  EXPECT_EQ(b.y[0], 100.0);
  EXPECT_EQ(b.x[1], 103.0);
}

}  // namespace
}  // namespace swath::io
