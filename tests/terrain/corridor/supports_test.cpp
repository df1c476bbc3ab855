// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/corridor/supports.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

namespace swath::terrain {
namespace {

/// Returns of a wire of sag parameter 600 m from `from` on, 150 m long, that hangs at 20 m at both ends.
Strand strand(const Eigen::Vector2d& from, double bearing, unsigned seed, double left_out = 2.0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.02);
  std::vector<WirePoint> points;
  std::vector<std::uint32_t> rows;
  const Eigen::Vector2d along(std::cos(bearing), std::sin(bearing));
  for (double u = left_out; u <= 150.0 - left_out; u += 0.5) {
    const Eigen::Vector2d p = from + u * along + noise(random) * Eigen::Vector2d(-along.y(), along.x());
    points.push_back({p.x(), p.y(), 20.0 + 600.0 * (std::cosh((u - 75.0) / 600.0) - std::cosh(75.0 / 600.0)) + noise(random), 1});
    rows.push_back(static_cast<std::uint32_t>(rows.size()));
  }
  return fit_strand(points, rows);
}

TEST(Supports, WiresMeetAtTheirSupportWithATrueSigma) {
  for (const double turn : {0.0, 0.4}) {
    double squares = 0.0, n = 0.0;
    for (unsigned seed = 0; seed < 60; ++seed) {
      const Strand a = strand({0, 0}, 0.0, 2 * seed + 1), b = strand({150, 0}, turn, 2 * seed + 2);
      const Meeting m = meeting_of(a, true, b, false, 25.0, 0.0);
      ASSERT_TRUE(m.found);
      EXPECT_EQ(m.in_plan, turn > 0.0);
      const double error = a.line.at(m.s).x() - 150.0;
      EXPECT_LT(std::abs(error), 0.15);  // m
      squares += std::pow(error / m.sigma, 2), ++n;
    }
    EXPECT_NEAR(std::sqrt(squares / n), 1.0, 0.3);  // 3 sigmas of 60 meetings
  }
}

TEST(Supports, WiresSideBySideAndFarEndsDoNotMeet) {
  const Strand a = strand({0, 0}, 0.0, 1);
  EXPECT_FALSE(meeting_of(a, true, strand({150, 4}, 0.0, 2), false, 25.0, 0.0).found);
  EXPECT_FALSE(meeting_of(a, true, strand({150, 0}, 0.0, 2), true, 25.0, 0.0).found);   // the other's far end
  EXPECT_FALSE(meeting_of(a, true, strand({230, 0}, 0.0, 2), false, 25.0, 0.0).found);  // a span apart
}

TEST(Supports, WiresSeenByDifferentFlightLinesMeetLessSurely) {
  CatenaryFit both, one, other;
  both.lines = {{1, 0.5}, {2, 0.5}};
  one.lines = {{1, 1.0}};
  other.lines = {{2, 1.0}};
  EXPECT_EQ(unlike_lines(both, both), 0.0);
  EXPECT_EQ(unlike_lines(both, one), 0.5);
  EXPECT_EQ(unlike_lines(one, other), 2.0);
  const Strand a = strand({0, 0}, 0.0, 1), b = strand({150, 0}, 0.0, 2);
  Strand c = b;
  for (LineOfFlight& l : c.fit.lines) l.line += 7;
  const double alike = meeting_of(a, true, b, false, 25.0, 0.02).sigma, unlike = meeting_of(a, true, c, false, 25.0, 0.02).sigma;
  EXPECT_EQ(alike, meeting_of(a, true, b, false, 25.0, 0.0).sigma);
  EXPECT_GT(unlike, 2.0 * alike);
}

TEST(Supports, APoleThatIsSeenFromOneSideHasATrueSigma) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  double squares = 0.0, n = 0.0;
  for (int pole = 0; pole < 400; ++pole) {
    // A square pole; two of its faces are seen, in shares that follow from the view.
    const double half = 0.15 + 0.2 * share(random), view = 0.5 * M_PI * share(random), turn = 2.0 * M_PI * share(random);
    std::vector<TowerPoint> points;
    for (int k = 4 + static_cast<int>(10.0 * share(random)); k > 0; --k) {
      const bool front = share(random) * (std::cos(view) + std::sin(view)) < std::cos(view);
      const double along = half * (2.0 * share(random) - 1.0), u = front ? half : along, v = front ? along : half;
      points.push_back(
          {50.0 + u * std::cos(turn) - v * std::sin(turn), 50.0 + u * std::sin(turn) + v * std::cos(turn), 20.0 * share(random)});
    }
    const std::vector<TowerGroup> groups = tower_groups(points);
    ASSERT_EQ(groups.size(), 1u);
    const Eigen::Vector2d e = groups[0].at - Eigen::Vector2d(50.0, 50.0);
    squares += e.dot(groups[0].covariance.inverse() * e);
    n += 2.0;
  }
  EXPECT_NEAR(std::sqrt(squares / n), 1.0, 0.2);
}

TEST(Supports, ReturnsOfTowersAreGroupsWithTheirMiddle) {
  std::vector<TowerPoint> points;
  for (int k = 0; k < 30; ++k) points.push_back({10.0 + 0.4 * std::sin(k), 5.0 + 0.4 * std::cos(k), 0.7 * k});
  for (int k = 0; k < 8; ++k) points.push_back({10.0 - 4.0 + k, 5.0, 21.0});  // arms
  for (int k = 0; k < 5; ++k) points.push_back({190.0, 5.0, 4.0 * k});
  points.push_back({400.0, 5.0, 9.0});  // one alone is none
  const std::vector<TowerGroup> groups = tower_groups(points);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_LT((groups[0].at - Eigen::Vector2d(10.0, 5.0)).norm(), 0.3);
  EXPECT_EQ(groups[0].returns, 38u);
  EXPECT_NEAR(groups[0].top, 21.0, 1e-9);
  EXPECT_LT((groups[1].at - Eigen::Vector2d(190.0, 5.0)).norm(), 1e-9);
  EXPECT_TRUE(tower_groups({}).empty());
}

}  // namespace
}  // namespace swath::terrain
