// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/forest/trees.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/ring.h"

namespace swath::terrain {
namespace {

struct Known {
  double x, y, height, radius;
};

/// Ellipsoids on level ground, `density` returns per m2 of what is highest.
core::Block forest(const std::vector<Known>& trees, double side, double density, unsigned seed) {
  core::Block b;
  b.origin = {4000.0, 7000.0, 0.0};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0.0, side);
  for (int k = 0; k < static_cast<int>(side * side * density); ++k) {
    const double x = place(random), y = place(random);
    double h = 0.0;
    for (const Known& t : trees) {
      const double d2 = (std::pow(x - t.x, 2) + std::pow(y - t.y, 2)) / (t.radius * t.radius);
      if (d2 < 1.0) h = std::max(h, t.height * (0.65 + 0.35 * std::sqrt(1.0 - d2)));
    }
    b.x.push_back(x), b.y.push_back(y), b.z.push_back(50.0 + h), b.height.push_back(static_cast<float>(h));
    b.classification.push_back(h > 0.0 ? 5 : 2), b.flags.push_back(0);
  }
  return b;
}

std::vector<Known> planted(double side, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<Known> out;
  for (double x = 5.0; x < side; x += 10.0)
    for (double y = 5.0; y < side; y += 10.0) {
      const double h = 8.0 + 16.0 * share(random);
      out.push_back({x + share(random), y + share(random), h, 0.2 * h});
    }
  return out;
}

TEST(Trees, TopsHeightsAndCrownsOfStandingTreesAreFound) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const std::vector<Known> trees = planted(60.0, seed);
    const core::Block b = forest(trees, 60.0, 8.0, seed);
    const std::vector<Tree> found = find_trees(b, b.x.size(), {});
    EXPECT_EQ(found.size(), trees.size());
    for (const Known& t : trees) {
      const auto near = std::min_element(found.begin(), found.end(), [&](const Tree& p, const Tree& q) {
        return std::hypot(p.x - t.x, p.y - t.y) < std::hypot(q.x - t.x, q.y - t.y);
      });
      EXPECT_LT(std::hypot(near->x - t.x, near->y - t.y), 1.0);
      EXPECT_NEAR(near->height, t.height, 0.1 * t.height);
      EXPECT_NEAR(std::sqrt(near->crown_area / M_PI), t.radius, 0.2 * t.radius + 0.2);
      EXPECT_GT(core::signed_area(near->crown), 0.9 * near->crown_area);
    }
  }
}

TEST(Trees, TilesAndTheOrderOfPointsChangeNothing) {
  const double side = 200.0, cut = 97.3;
  const std::vector<Known> trees = planted(side, 9);
  const core::Block b = forest(trees, side, 2.0, 9);
  const std::vector<Tree> whole = find_trees(b, b.x.size(), {});
  std::vector<Tree> parts;
  for (const bool west : {true, false}) {
    core::Block part;
    part.origin = b.origin;
    size_t own = 0;
    for (const bool mine : {true, false})
      for (size_t k = b.x.size(); k-- > 0;) {
        const double past = west ? b.x[k] - cut : cut - b.x[k];
        const bool in = west ? b.x[k] < cut : b.x[k] >= cut;
        if (in != mine || (!mine && past > trees_halo({}))) continue;
        part.x.push_back(b.x[k]), part.y.push_back(b.y[k]), part.z.push_back(b.z[k]), part.height.push_back(b.height[k]);
        part.classification.push_back(b.classification[k]), part.flags.push_back(0);
        own += mine;
      }
    for (Tree& t : find_trees(part, own, {})) parts.push_back(std::move(t));
  }
  ASSERT_EQ(parts.size(), whole.size());
  for (size_t k = 0; k < whole.size(); ++k) {
    EXPECT_EQ(parts[k].x, whole[k].x);
    EXPECT_EQ(parts[k].crown_area, whole[k].crown_area);
    EXPECT_EQ(parts[k].crown.size(), whole[k].crown.size());
  }
}

TEST(Trees, WithoutTreesThereAreNone) {
  const core::Block b = forest({}, 30.0, 4.0, 1);
  EXPECT_TRUE(find_trees(b, b.x.size(), {}).empty());
  EXPECT_TRUE(find_trees({}, 0, {}).empty());
}

}  // namespace
}  // namespace swath::terrain
