// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/predicates.h"

#include <gtest/gtest.h>

#include <random>

namespace swath::terrain {
namespace {

TEST(Predicates, TellTheSides) {
  EXPECT_EQ(orientation({0, 0}, {1, 0}, {0, 1}), 1);
  EXPECT_EQ(orientation({0, 0}, {0, 1}, {1, 0}), -1);
  EXPECT_EQ(in_circle({0, 0}, {1, 0}, {0, 1}, {0.5, 0.5}), 1);
  EXPECT_EQ(in_circle({0, 0}, {1, 0}, {0, 1}, {1.5, 0.5}), -1);
}

TEST(Predicates, ZeroIsExact) {
  // Whole multiples of 2^-10 far from the origin: on the line and circle exactly, and one last bit beside.
  std::mt19937 random(1);
  std::uniform_int_distribution<int> part(-100000, 100000);
  for (int n = 0; n < 1000; ++n) {
    const double x = 500.0 + part(random) / 1024.0, y = 700.0 + part(random) / 1024.0, u = part(random) / 1024.0, v = part(random) / 1024.0;
    if (u == 0.0 || v == 0.0) continue;
    const Place a{x, y}, b{x + u, y + v}, c{x + 2 * u, y + 2 * v};
    ASSERT_EQ(orientation(a, b, c), 0);
    const Place beside{c.x, std::nextafter(c.y, 1e9)};
    ASSERT_EQ(orientation(a, b, beside), u > 0 ? 1 : -1);
    // A square turned by (u, v).
    const Place p{x, y}, q{x + u, y + v}, r{x + u - v, y + v + u}, s{x - v, y + u};
    ASSERT_EQ(in_circle(p, q, r, s), 0);
    ASSERT_EQ(in_circle(p, q, r, {s.x + (p.x + r.x > 2 * s.x ? 1e-10 : -1e-10), s.y}), 1);
    ASSERT_EQ(in_circle(p, q, r, {s.x - (p.x + r.x > 2 * s.x ? 1e-10 : -1e-10), s.y}), -1);
  }
}

}  // namespace
}  // namespace swath::terrain
