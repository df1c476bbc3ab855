// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/geometry_pass.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/units.h"

namespace swath::calib {
namespace {

/// Along a course, not quite straight.
Pass pass_along(double course) {
  Pass p;
  p.course = course;
  for (int i = 0; i <= 200; ++i) {
    const double along = 25.0 * i, across = 20 * std::sin(0.05 * i);
    p.time.push_back(1000 + 0.5 * i);
    p.track.emplace_back(along * std::sin(course) + across * std::cos(course), along * std::cos(course) - across * std::sin(course));
  }
  return p;
}

TEST(CourseBox, TheNearestPointIsThatOfAllPoints) {
  for (const double course : {0.0, 0.7, 2.5, -1.2}) {
    const Pass p = pass_along(course);
    const CourseBox box(p);
    for (double x = -600; x < 5600; x += 190)
      for (double y = -5600; y < 5600; y += 330) {
        double least = 1e300, time = 0;
        for (size_t i = 0; i < p.track.size(); ++i)
          if (const double d = (p.track[i] - Eigen::Vector2d(x, y)).norm(); d < least) least = d, time = p.time[i];
        for (const double reach : {50.0, 400.0, 1e9, std::numeric_limits<double>::infinity()}) {
          const auto found = box.nearest({x, y}, reach);
          ASSERT_EQ(found.has_value(), least < reach) << course << " " << x << " " << y << " " << reach;
          if (found) {
            EXPECT_EQ(found->first, least);
            EXPECT_EQ(found->second, time);
          }
        }
      }
  }
}

}  // namespace
}  // namespace swath::calib
