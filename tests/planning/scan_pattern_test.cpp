// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/scan_pattern.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::planning {
namespace {

TEST(ScanPattern, SharesAddUpToOne) {
  for (const ScanPattern p : {ScanPattern::triangle, ScanPattern::sine, ScanPattern::polygon}) {
    double sum = 0.0;
    for (int k = -10; k < 10; ++k) sum += pulse_share(p, 0.4, 0.04 * k, 0.04 * (k + 1));
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_EQ(pulse_share(p, 0.4, 0.4, 0.9), 0.0);
    EXPECT_NEAR(pulse_share(p, 0.4, -1.0, 0.0), 0.5, 1e-12);
  }
}

/// A swing sampled evenly in time.
TEST(ScanPattern, ASineIsDenseAtItsEdges) {
  constexpr int n = 200000;
  int middle = 0, edge = 0;
  for (int k = 0; k < n; ++k) {
    const double angle = 0.4 * std::sin(2 * M_PI * k / n);
    if (std::abs(angle) < 0.02) ++middle;
    if (angle > 0.36) ++edge;
  }
  EXPECT_NEAR(pulse_share(ScanPattern::sine, 0.4, -0.02, 0.02), static_cast<double>(middle) / n, 1e-4);
  EXPECT_NEAR(pulse_share(ScanPattern::sine, 0.4, 0.36, 0.4), static_cast<double>(edge) / n, 1e-4);
  EXPECT_NEAR(pulse_share(ScanPattern::sine, 0.4, -1e-4, 1e-4) / pulse_share(ScanPattern::triangle, 0.4, -1e-4, 1e-4),
              nadir_share(ScanPattern::sine), 1e-6);
}

TEST(ScanPattern, LinesAndSpeeds) {
  EXPECT_EQ(lines_per_second(ScanPattern::triangle, 50), 100);
  EXPECT_EQ(lines_per_second(ScanPattern::polygon, 50), 50);
  EXPECT_NEAR(angular_speed(ScanPattern::triangle, 0.3, 50), 60, 1e-12);
}

}  // namespace
}  // namespace swath::planning
