// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/wires.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

using test::add_point;

std::vector<std::uint8_t> all(const core::Block& b) { return std::vector<std::uint8_t>(b.size(), 1); }
std::vector<std::uint8_t> wires(const core::Block& b) {
  return wire_points(b, all(b), std::vector<std::uint8_t>(b.size(), 0), districts(b), b.size());
}

/// A span, its returns `spacing` apart on average and up to 10 cm off.
void add_wire(core::Block& b, double offset, double height, double spacing, unsigned seed, double length = 120.0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (double u = 0.0; u < length; u += std::min(spacing * (0.3 + 1.4 * uniform(random)), 6.9)) {
    const double side = offset + 0.2 * (uniform(random) - 0.5);
    add_point(b, 0.8 * u - 0.6 * side, 0.6 * u + 0.8 * side,
              height + 500.0 * (std::cosh((u - 60.0) / 500.0) - 1.0) + 0.1 * (uniform(random) - 0.5));
  }
}

double share(const std::vector<std::uint8_t>& found) {
  double n = 0;
  for (const std::uint8_t w : found) n += w != 0;
  return n / static_cast<double>(found.size());
}

TEST(Wires, ThreeWiresSideBySideAreFoundToTheirEnds) {
  core::Block b;
  for (const double offset : {-3.0, 0.0, 3.0})
    for (double u = 0.0; u < 120.0; u += 1.3 + 0.4 * std::sin(u + offset))
      add_point(b, 0.8 * u - 0.6 * offset, 0.6 * u + 0.8 * offset,
                20.0 + 500.0 * (std::cosh((u - 60.0) / 500.0) - 1.0) + 0.03 * std::sin(7 * u));
  const std::vector<std::uint8_t> wire = wires(b);
  for (size_t p = 0; p < b.size(); ++p) EXPECT_TRUE(wire[p]) << b.x[p] << " " << b.y[p];
}

TEST(Wires, ThinReturnsAndCloseWiresAreFound) {
  struct Case {
    double spacing, apart, found;
  };
  for (const Case& c : {Case{3.5, 3.0, 0.85}, Case{2.0, 3.0, 0.97}, Case{0.5, 0.8, 0.93}}) {
    core::Block b;
    for (unsigned k = 0; k < 3; ++k) add_wire(b, c.apart * k, 20.0, c.spacing, k + 1);
    EXPECT_GE(share(wires(b)), c.found) << c.spacing;
  }
}

TEST(Wires, TheyAreFollowedIntoASupportAtWhichTheirSlopeChanges) {
  core::Block b;
  const auto height = [](double x) { return 20.0 - 0.1 * std::abs(x) + 0.0007 * x * x; };
  for (int k = 0; k < 1200; ++k) {
    const double x = -60.0 + 0.1 * k;
    add_point(b, x, 0.0, height(x));
  }
  const size_t end = b.size();
  for (int k = 0; k < 600; ++k) add_point(b, 0.9 * std::sin(7.0 * k), 6.0 * std::sin(3.0 * k), 18.0 + 3.0 * std::cos(5.0 * k));
  const std::vector<std::uint8_t> wire = wires(b);
  double near = 0, found = 0;
  for (size_t p = 0; p < end; ++p)
    if (std::abs(b.x[p]) <= 9.0) near += 1, found += wire[p] != 0;
  EXPECT_GE(found, 0.85 * near);
}

TEST(Wires, CrownsMastsEavesAndSinglePointsAreNone) {
  test::Scene s = test::make_scene("forest");
  std::vector<std::uint8_t> candidate(s.block.size());
  for (size_t p = 0; p < candidate.size(); ++p) candidate[p] = s.truth[p] != core::point_class::ground;
  double found = 0;
  for (const std::uint8_t w :
       wire_points(s.block, candidate, std::vector<std::uint8_t>(s.block.size(), 0), districts(s.block), s.block.size()))
    found += w;
  constexpr double bearable = 0.0005;  // of the returns from thin crowns
  EXPECT_LE(found, bearable * static_cast<double>(s.block.size()));

  core::Block mast;
  for (int k = 0; k < 20; ++k) add_point(mast, 10.0, 10.0, 10.0 + k);
  EXPECT_EQ(share(wires(mast)), 0.0);

  core::Block steep;
  for (int k = 0; k < 20; ++k) add_point(steep, 1.5 * k, 10.0, 10.0 + 2.0 * k);
  EXPECT_EQ(share(wires(steep)), 0.0);

  // A roof whose returns lie on a plane, those of its edge a little off.
  core::Block roof;
  std::vector<std::uint8_t> edge, plane;
  for (double y = 0.0; y < 10.0; y += 0.7)
    for (double x = 0.0; x < 30.0; x += 0.7) {
      add_point(roof, x, y, y == 0.0 ? 9.8 : 10.0);
      edge.push_back(y == 0.0);
      plane.push_back(y != 0.0);
    }
  EXPECT_EQ(share(wire_points(roof, edge, plane, districts(roof), roof.size())), 0.0);
  EXPECT_GT(share(wire_points(roof, edge, std::vector<std::uint8_t>(roof.size(), 0), districts(roof), roof.size())),
            0.0);  // without the roof beside it
}

TEST(Wires, DoNotDependOnTheOrderOrOnWhatIsFar) {
  core::Block b;
  for (unsigned k = 0; k < 3; ++k) add_wire(b, 3.0 * k, 20.0, 3.5, k + 1, 200.0);
  const std::vector<std::uint8_t> whole = wires(b);
  std::vector<std::uint32_t> rows;
  const core::Block other = test::shuffled(b, 5, rows);
  const std::vector<std::uint8_t> again = wires(other);
  for (size_t k = 0; k < rows.size(); ++k) EXPECT_EQ(again[k], whole[rows[k]]);
  const auto near = [&](size_t p) { return std::hypot(b.x[p] - 10.0, b.y[p] - 10.0) <= wire_points_halo(); };
  core::Block part;
  rows.clear();
  for (std::uint32_t p = 0; p < b.size(); ++p)
    if (near(p)) rows.push_back(p);
  part = core::select(b, rows);
  ASSERT_LT(part.size(), b.size());
  const std::vector<std::uint8_t> local = wires(part);
  for (size_t k = 0; k < rows.size(); ++k)
    if (std::hypot(part.x[k] - 10.0, part.y[k] - 10.0) < 2.0) {
      EXPECT_EQ(local[k], whole[rows[k]]);
    }
}

}  // namespace
}  // namespace swath::filters
